// Edits added, changed and removed in the text of a config.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "pipeline/config/edit_text.h"
#include "tests/pipeline/config/config_texts.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using testing::least_config;

const EditKeys sphere_keys = {{"shape", {"sphere"}},
                              {"center", {ConfigValue::List{{1}, {2.5}, {3}}}},
                              {"radius", {std::int64_t{4}}}};

std::string added(const std::string& text) {
  EditText edits(text, "scan.toml");
  edits.add(sphere_keys);
  return edits.text();
}
std::string changed(const std::string& text, std::size_t number, const EditKeys& keys) {
  EditText edits(text, "scan.toml");
  edits.change(number, keys);
  return edits.text();
}
std::string removed(const std::string& text, std::size_t number) {
  EditText edits(text, "scan.toml");
  edits.remove(number);
  return edits.text();
}
std::string refusal(const std::string& text, std::size_t removed_number = 1) {
  return testing::error_text<InputError>([&] { removed(text, removed_number); });
}

TEST(EditText, AddsBehindAllElse) {
  EXPECT_EQ(added("a = 1\n[run]\nthreads = 1 # two\n# end\n"),
            "a = 1\n[run]\nthreads = 1 # two\n# end\n"
            "\n[[edit]]\nshape = \"sphere\"\ncenter = [1, 2.5, 3]\nradius = 4\n");
}

TEST(EditText, EndsLinesAndTheTextAsItDid) {
  const std::string table = "[[edit]]\r\nshape = \"sphere\"\r\ncenter = [1, 2.5, 3]\r\nradius = 4";
  EXPECT_EQ(added("a = 1\r\n"), "a = 1\r\n\r\n" + table + "\r\n");
  EXPECT_EQ(added("a = 1\r\nb = 2"), "a = 1\r\nb = 2\r\n\r\n" + table);
  EXPECT_EQ(changed("a = 1\r\n[[edit]]\r\nradius = 1\r\n", 1, {{"op", {"add"}}}),
            "a = 1\r\n[[edit]]\r\nradius = 1\r\nop = \"add\"\r\n");
  EXPECT_EQ(changed("[[edit]]\nradius = 1", 1, {{"radius", {2.0}}, {"op", {"add"}}}),
            "[[edit]]\nradius = 2.0\nop = \"add\"");
  EXPECT_EQ(removed("a = 1\r\n[[edit]]\r\nradius = 1", 1), "a = 1");
}

TEST(EditText, ChangesTheValueAndNothingBeside) {
  const std::string before =
      "\xef\xbb\xbf# \xc3\xa4\n[[edit]]\n[[ edit ]] # b\n  'radius'=4# mm\n"
      "  center = [ # \xc3\xb6 ]\n    1, 2,\n    3] # \xc3\xbc\n\n# end\n[run]\nthreads = 1\n";
  EXPECT_EQ(changed(before, 2,
                    {{"center", {ConfigValue::List{{0}, {0}, {0}}}},
                     {"radius", {0.5}},
                     {"op", {"subtract"}}}),
            "\xef\xbb\xbf# \xc3\xa4\n[[edit]]\n[[ edit ]] # b\n  'radius'=0.5# mm\n"
            "  center = [0, 0, 0] # \xc3\xbc\n  op = \"subtract\"\n\n# end\n[run]\nthreads = 1\n");
  EXPECT_EQ(changed(before, 1, {{"op", {"add"}}}).substr(8, 20), "[[edit]]\nop = \"add\"\n");
}

TEST(EditText, DropsWholeLines) {
  EditText edits("[[edit]]\nsize = [1,\n 2, 3] # gone\n# stays\nradius = 1\n", "scan.toml");
  edits.drop(1, std::vector<std::string>{"size", "height"});
  EXPECT_EQ(edits.text(), "[[edit]]\n# stays\nradius = 1\n");
}

TEST(EditText, RemovesATableWithItsOwnCommentAndGap) {
  const std::string a = "a = 1\n", one = "[[edit]]\nradius = 1 # r\n# in it\nop = 'add'\n",
                    two = "[[edit]]\nradius = 2\n", run = "[run]\nthreads = 1\n";
  EXPECT_EQ(removed(a + "\n" + one + "\n" + two + "\n" + run, 1), a + "\n" + two + "\n" + run);
  EXPECT_EQ(removed(a + "\n" + one + "\n" + two + "\n" + run, 2), a + "\n" + one + "\n" + run);
  EXPECT_EQ(removed(a + "\n# of one\n# too\n" + one + "\n# of two\n" + two, 1),
            a + "\n# of two\n" + two);
  // Whose a comment is that stands between two lines is not known, so it stays.
  EXPECT_EQ(removed(a + "# whose\n" + one + run, 1), a + "# whose\n" + run);
  EXPECT_EQ(removed("# file\n" + one + run, 1), "# file\n" + run);
  EXPECT_EQ(removed(a + "\n" + one + "# behind\n", 1), a + "\n# behind\n");
  EXPECT_EQ(removed(one + two, 1), two);
  EXPECT_EQ(removed(one, 1), "");
}

TEST(EditText, IsNotMisledByWhatOnlyLooksLikeTables) {
  const std::string text =
      "[slurm]\nprologue = [\"\"\"\n[[edit]]\nradius = 9\n\n# [[edit]]\"\"\"]\n# [[edit]]\n";
  EXPECT_EQ(EditText(text, "scan.toml").count(), 0U);
  EXPECT_EQ(removed(added(text), 1), text);
}

TEST(EditText, RefusesWhatItCannotChange) {
  const std::string inline_list = "scan.toml:2:1: edits can be changed only where each is a table";
  EXPECT_NE(refusal("a = 1\nedit = []\n").find(inline_list), std::string::npos);
  EXPECT_NE(refusal("a = 1\nedit = [{radius = 1}]\n").find("each is a table [[edit]]"),
            std::string::npos);
  EXPECT_NE(refusal("a = 1\n[edit]\nradius = 1\n").find("each is a table"), std::string::npos);
  EXPECT_NE(refusal("[[edit]]\n[edit.center]\nx = 1\n").find("edit 1: center is a table"),
            std::string::npos);
  EXPECT_NE(refusal("[[edit]]\ncenter.x = 1\n").find("edit 1: center is a table"),
            std::string::npos);
  EXPECT_NE(refusal("a = \n").find("scan.toml:1:"), std::string::npos);
  EXPECT_NE(refusal("a = 1\n").find("there is no edit 1"), std::string::npos);
  EXPECT_NE(refusal("[[edit]]\n", 2).find("expected 1 to 1"), std::string::npos);
  EXPECT_NE(refusal("[[edit]]\n", 0).find("there is no edit 0"), std::string::npos);
}

// A text of tables, comments and gaps in any order.
std::string any_text() {
  const std::vector<std::string> pieces = {"\n",
                                           " \t\n",
                                           "# note\n",
                                           "[[edit]]\nradius = 1\n",
                                           "  [[edit]] # x\n  center = [1,\n\n2]\n",
                                           "[[edit]]\n# r\nop = 'add'\n# s\n"};
  std::string text = "b = 2\n";
  for (const std::string& piece :
       *rc::gen::container<std::vector<std::string>>(rc::gen::elementOf(pieces)))
    text += piece;
  if (*rc::gen::arbitrary<bool>()) text += "[run]\nthreads = 1\n";
  if (*rc::gen::arbitrary<bool>()) text.pop_back();
  if (!*rc::gen::arbitrary<bool>()) return text;
  std::string windows;
  for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
  return windows;
}

RC_GTEST_PROP(EditText, RemovingUndoesAdding, ()) {
  const std::string text = any_text();
  const std::string more = added(text);
  RC_ASSERT(more.starts_with(text.substr(0, text.find_last_not_of("\r\n") + 1)));
  RC_ASSERT(removed(more, EditText(more, "scan.toml").count()) == text);
}

// Each check of itself holds too: nothing else changes its meaning.
RC_GTEST_PROP(EditText, AnyEditCanBeChangedAndRemoved, ()) {
  EditText edits(any_text(), "scan.toml");
  while (edits.count() > 0) {
    const auto number = *rc::gen::inRange<std::size_t>(1, edits.count() + 1);
    const std::size_t count = edits.count();
    edits.change(number, sphere_keys);
    edits.drop(number, std::vector<std::string>{"op", "center"});
    edits.remove(number);
    RC_ASSERT(edits.count() == count - 1);
  }
  RC_ASSERT(edits.text().starts_with("b = 2"));
}

}  // namespace
}  // namespace voxweld
