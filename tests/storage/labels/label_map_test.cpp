// Label maps: what each format says of a label, and what is refused.
#include "storage/labels/label_map.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TempDirectory;

using Entries = std::vector<MaterialRange>;

MaterialRange own(std::uint64_t label) {
  return {label, label, true, exterior};
}
MaterialRange to(std::uint64_t label, Material material) {
  return {label, label, false, material};
}
MaterialRange out(std::uint64_t label) {
  return to(label, exterior);
}
MaterialEntry entry(Material material, const std::string& name,
                    std::optional<MaterialColor> color = {}) {
  return {material, name, color};
}
constexpr MaterialColor orange{255, 128, 0};

LabelMap parse(const std::string& text, const std::string& name = "labels.csv") {
  return parse_label_map(text, "/data/" + name);
}

std::string error_of(const std::string& text, const std::string& name = "labels.csv") {
  return testing::error_text<FormatError>([&] { parse(text, name); });
}

TEST(LabelMap, ColumnsInAnyOrder) {
  const LabelMap map = parse(
      "label,material,name,color\n"
      "7,2,liver,#ff8000\n"
      "3,,gone,\n"
      "5,-1,,\n"
      "9,2,\"left, \"\"upper\"\" lobe\",\"1,2,3\"\n"
      "18446744073709551614,18446744073709551613,last,\n");
  EXPECT_EQ(map.entries, (Entries{out(3), out(5), to(7, 2), to(9, 2),
                                  to(18446744073709551614U, 18446744073709551613U)}));
  EXPECT_EQ(map.materials.entries,
            (std::vector{entry(2, "liver", orange), entry(18446744073709551613U, "last")}));
  const LabelMap other = parse(
      "# written by hand\r\n\r\nName;Old ID;New ID;Red;Green;Blue;note\r\n"
      "liver;7;2;255;128;0;x\r\n"
      "gone;3;;;;\r\n  # more\r\n"
      "; 5 ;-1;;;;\r\n"
      "\"left, \"\"upper\"\" lobe\";9;2;1;2;3;\r\n"
      "last;18446744073709551614;18446744073709551613");
  EXPECT_EQ(other.entries, map.entries);
  EXPECT_EQ(other.materials, map.materials);
}

TEST(LabelMap, WithoutMaterialsLabelsStay) {
  const LabelMap map = parse("\xef\xbb\xbfID\tlabel_name\n4\taorta\n1\t\n", "a.tsv");
  EXPECT_EQ(map.entries, (Entries{own(1), own(4)}));
  EXPECT_EQ(map.materials.entries, (std::vector{entry(4, "aorta")}));
  EXPECT_EQ(parse("label\n4\n").entries, (Entries{own(4)}));
  EXPECT_TRUE(parse("label,name\n").entries.empty());
}

TEST(LabelMap, RangesBecomeOneMaterial) {
  EXPECT_EQ(parse("label,material,name\n10-20,1,all\n21 - 30,,\n").entries,
            (Entries{{10, 20, false, 1}, {21, 30, false, exterior}}));
  EXPECT_EQ(parse("label\n10-20\n").entries, (Entries{{10, 20, true, exterior}}));
  EXPECT_THAT(error_of("label,name\n10-20,all\n"), HasSubstr(":2: the labels 10-20 have one name"));
}

// The word of a material's own label comes first, then that of the first line.
TEST(LabelMap, OneNameAndColorAMaterial) {
  const LabelMap map = parse(
      "label,material,name,color\n8,5,eight,\n9,5,nine,#010203\n5,5,five,\n6,7,six,#000000\n"
      "4,7,four,#ff8000\n5000,,unseen,\n");
  EXPECT_EQ(map.materials.entries, (std::vector{entry(5, "five", MaterialColor{1, 2, 3}),
                                                entry(7, "six", MaterialColor{0, 0, 0})}));
  EXPECT_EQ(map.materials.find(7)->name, "six");
  EXPECT_EQ(map.materials.find(6), nullptr);
  EXPECT_EQ(map.materials.find(8), nullptr);
}

TEST(LabelMap, Json) {
  const Entries expected = {out(1), to(2, 9), own(3), to(4, 18446744073709551614U), out(5), own(6)};
  const LabelMap list = parse(R"([
  {"label": 1, "material": null},
  {"label": "2", "material": 9, "name": "nine", "colour": [255, 128, 0]},
  {"label": 3, "name": "three", "color": "#ff8000", "voxels": 1e9, "more": {"name": [{"label": 7}]}},
  {"label": 4, "material": 18446744073709551614},
  {"material": -1, "label": 5}, {"label": 6, "name": null}
])",
                              "labels.txt");
  EXPECT_EQ(list.entries, expected);
  EXPECT_EQ(list.materials.entries,
            (std::vector{entry(3, "three", orange), entry(9, "nine", orange)}));
  const LabelMap object = parse(R"({"1": "", "4": "18446744073709551614", "5": null, "6": {},
  "2": {"material": "9", "name": "nine", "color": "255 128 0"}, "3": {"name": "three",
  "color": "#FF8000"}})",
                                "labels.json");
  EXPECT_EQ(object.entries, expected);
  EXPECT_EQ(object.materials, list.materials);
  const LabelMap names = parse(R"({"1": "liver", "2": 7, "3": "-1"})", "labels.json");
  EXPECT_EQ(names.entries, (Entries{own(1), to(2, 7), out(3)}));
  EXPECT_EQ(names.materials.entries, (std::vector{entry(1, "liver")}));
}

TEST(LabelMap, ColorTablesOfOtherPrograms) {
  const LabelMap slicer = parse(
      "# Color table file a.ctbl\n# 3 values\n0 background 0 0 0 0\n1 left_lung 255 128 0 255\n"
      "12 \"right lung\" 1 2 3 255\n",
      "a.ctbl");
  EXPECT_EQ(slicer.entries, (Entries{own(0), own(1), own(12)}));
  EXPECT_EQ(
      slicer.materials.entries,
      (std::vector{entry(0, "background", MaterialColor{0, 0, 0}), entry(1, "left_lung", orange),
                   entry(12, "right lung", MaterialColor{1, 2, 3})}));
  const LabelMap free_surfer = parse(
      "#$Id: FreeSurferColorLUT.txt $\n\n#No. Label Name:      R   G   B   A\n\n"
      "2   Left-Cerebral-White-Matter  245 245 245 0\n14 3rd Ventricle 2 204 182 44\n"
      "15 of 4 255 128 0 0\n",
      "lut.txt");
  EXPECT_EQ(free_surfer.materials.entries,
            (std::vector{entry(2, "Left-Cerebral-White-Matter", MaterialColor{245, 245, 245}),
                         entry(14, "3rd Ventricle", MaterialColor{2, 204, 182}),
                         entry(15, "of 4", orange)}));
  const LabelMap snap = parse(
      "################\n# ITK-SnAP Label Description File\n# IDX   -R-  -G-  -B-  -A--  VIS MSH  "
      "LABEL\n    0     0    0    0        0  0  0    \"Clear Label\"\n"
      "    1   255  128    0      0.5  1  1    \"Label 1\"\n",
      "a.label");
  EXPECT_EQ(snap.entries, (Entries{own(0), own(1)}));
  EXPECT_EQ(snap.materials.entries, (std::vector{entry(0, "Clear Label", MaterialColor{0, 0, 0}),
                                                 entry(1, "Label 1", orange)}));
}

TEST(LabelMap, ErrorsNameTheLine) {
  const std::string header = "label,material,name,color\n";
  const auto say = [&](const std::string& row) { return error_of(header + "1,1,a,\n" + row); };
  EXPECT_EQ(
      say("x,1,,\n"),
      "/data/labels.csv:3: expected a label, a whole number of at least 0, or a range such as "
      "10-20, found 'x'");
  EXPECT_THAT(say("-5,1,,\n"), HasSubstr(":3: expected a label"));
  EXPECT_THAT(say("5.0,1,,\n"), HasSubstr("found '5.0'"));
  EXPECT_THAT(say("9-5,1,,\n"), HasSubstr("the lower label of a range first, found '9-5'"));
  EXPECT_THAT(say("18446744073709551615,1,,\n"), HasSubstr("labels end at 18446744073709551614"));
  EXPECT_THAT(say("5,18446744073709551615,,\n"),
              HasSubstr("materials end at 18446744073709551614"));
  EXPECT_THAT(say("5,liver,,\n"), HasSubstr(":3: expected a material"));
  EXPECT_THAT(say("5,-2,,\n"), HasSubstr("found '-2'"));
  EXPECT_THAT(say("5,1,a,red\n"), HasSubstr(":3: expected a colour such as #ff8000"));
  EXPECT_THAT(say("5,1,a,#ff80\n"), HasSubstr("found '#ff80'"));
  EXPECT_THAT(say("5,1,a,\"1,2,256\"\n"), HasSubstr("from 0 to 255, found '256'"));
  EXPECT_THAT(say("5\n"), HasSubstr(":3: expected 4 cells as in the header row, found 1"));
  EXPECT_THAT(say("5,1,a,#ff8000,6\n"), HasSubstr("found 5"));
  EXPECT_THAT(say("\"5,1\n\n"), HasSubstr(":3: a quote is opened and never closed"));
  EXPECT_THAT(say("5,1,\"a\"b,\n"), HasSubstr("behind the closing quote of 'a'"));
  EXPECT_THAT(say("5,1,\"a\nb\",\n"), HasSubstr("holds a line break"));
  EXPECT_THAT(say("5,1,caf\xe9,\n"), HasSubstr(":3: the name of label 5 is not UTF-8"));
  EXPECT_THAT(say("2,1,,\n# 5\n\n1,2,,\n"),
              HasSubstr(":6: label 1 is named in line 2 already; keep one of the two"));
  EXPECT_THAT(say("0-1,2,,\n"), HasSubstr(":3: label 1 is named in line 2 already"));
  // Line breaks within quotes count.
  EXPECT_THAT(error_of("label,name,\"a\nnote\"\n1,a,\"b\nc\"\nx,,\n"),
              HasSubstr(".csv:5: expected"));
}

TEST(LabelMap, WarnsOfEmptyMaterials) {
  EXPECT_THAT(parse("label,name,material\n1,a,2\n\n5,b,\n6,c,-1\n7-9,d, \n").warnings,
              ::testing::ElementsAre(
                  "/data/labels.csv:4: column 3 (material) is empty, so label 5 is left out; write "
                  "-1 if that is meant",
                  "/data/labels.csv:6: column 3 (material) is empty, so labels 7-9 are left out; "
                  "write -1 if that is meant"));
  const auto many = parse("label,material\n1,\n2,\n3,\n4,\n5,\n6,1\n").warnings;
  ASSERT_EQ(many.size(), 4U);
  EXPECT_EQ(many.back(),
            "/data/labels.csv: column material is empty in 2 more lines, and their labels are left "
            "out");
  EXPECT_TRUE(parse("label,name,color\n1,,\n2,,\n").warnings.empty());
}

TEST(LabelMap, WarnsOfUnknownColumns) {
  EXPECT_THAT(parse("label,metarials\n1,2\n").warnings,
              ::testing::ElementsAre("/data/labels.csv:1: column 2 (metarials) is not looked at; "
                                     "known are label, material, name, color, r, g and b"));
  EXPECT_THAT(parse("# x\nvoxels;id;name;note\n9;1;a;b\n").warnings,
              ::testing::ElementsAre(HasSubstr(":2: column 1 (voxels), 4 (note) are not looked")));
}

TEST(LabelMap, ErrorsOfTheHeader) {
  EXPECT_THAT(error_of(""), StartsWith("/data/labels.csv:1: expected a header row such as"));
  EXPECT_THAT(error_of("1,2,liver\n"), HasSubstr(":1: expected a header row such as label,"));
  EXPECT_THAT(error_of("label,id\n"), HasSubstr(":1: the columns 1 and 2 are both of the label"));
  EXPECT_THAT(error_of("label,materail\n"), HasSubstr("unknown column 'materail'; did you mean "
                                                      "material?"));
  EXPECT_THAT(error_of("label,colr\n"), HasSubstr("did you mean color?"));
  EXPECT_EQ(parse("label,name,names\n1,a,b\n").materials.entries, (std::vector{entry(1, "a")}));
  EXPECT_THAT(error_of("label,r,g\n"), HasSubstr("expected the columns r, g and b"));
  EXPECT_THAT(error_of("color,label\n"), HasSubstr("put another column first"));
  EXPECT_THAT(error_of("\xff\xfel\0a\0"), HasSubstr("is in UTF-16"));
  EXPECT_THAT(error_of("1 liver\n", "a.txt"), HasSubstr("a.txt:1: expected label, name, red"));
  EXPECT_THAT(error_of("1 liver 1 2 300 0\n", "a.txt"), HasSubstr("found '300'"));
  EXPECT_THAT(error_of("1 a 1 2 3 0\n1 b 1 2 3 0\n", "a.txt"), HasSubstr(":2: label 1 is named"));
}

TEST(LabelMap, ErrorsOfJson) {
  const auto say = [](const std::string& text) { return error_of(text, "a.json"); };
  EXPECT_THAT(say(""), StartsWith("/data/a.json:1: not valid JSON"));
  EXPECT_THAT(say("[\n{\"label\": 1,\n}]"), HasSubstr("a.json:3: not valid JSON here: "));
  EXPECT_THAT(say("7"), HasSubstr("expected an object of labels or a list of entries"));
  EXPECT_THAT(say("[\n5]"), HasSubstr(":2: expected an entry such as"));
  EXPECT_THAT(say("[\n{\"material\": 5}]"), HasSubstr(":2: an entry without the key \"label\""));
  EXPECT_THAT(say("[{\"label\": 5,\n\"materail\": 5}]"), HasSubstr(":2: unknown key 'materail'"));
  EXPECT_THAT(say("{\"background\": 0, \"liver\": 1}"), HasSubstr("found 'background'"));
  EXPECT_THAT(say("{\"1\": 2,\n\n\"1\": 3}"), HasSubstr(":3: label 1 is named in line 1 already"));
  EXPECT_THAT(say("{\"1\": [2]}"), HasSubstr("found a list"));
  EXPECT_THAT(say("{\"1\": true}"), HasSubstr("found 'true'"));
  EXPECT_THAT(say("{\"1\": {\"color\": [1, 2]}}"), HasSubstr("expected a colour"));
  EXPECT_THAT(say("{\"1\": {\"material\": {}}}"), HasSubstr("found an object"));
  EXPECT_THAT(say("{\"1\": -7}"), HasSubstr("found '-7'"));
  EXPECT_THAT(say("{\"1\": 2.5}"), HasSubstr("found '2.5'"));
}

TEST(LabelMap, FilesThatAreNone) {
  const TempDirectory directory;
  EXPECT_THROW(read_label_map(directory / "none.csv"), InputError);
  EXPECT_THROW(read_label_map(directory.path()), InputError);
  write_whole_file(directory / "a.csv", as_bytes("label,name\n5,a\n"), Durability::rename_only);
  EXPECT_EQ(read_label_map(directory / "a.csv").entries, (Entries{own(5)}));
}

// Whatever the bytes, the answer is a map or one FormatError.
TEST(LabelMap, SurvivesDamage) {
  const std::string csv = "label,material,name,color\n7,2,\"li\"\"ver\",#ff8000\n3-9,,x,\n";
  const std::string json = "[{\"label\": 7, \"color\": [1, 2, 3], \"x\": {\"y\": [null]}}]";
  const std::string table = "1 \"a b\" 1 2 3 4\n2 255 0 0 1 1 1 \"x\"\n";
  for (const std::string& whole : {csv, json, table})
    for (std::size_t i = 0; i <= whole.size(); ++i) {
      error_of(whole.substr(0, i), "a.txt");
      for (const char c : {'"', '{', ']', ',', '\n', '\0', '\xff', '9'}) {
        std::string text = whole;
        text.insert(i, 1, c);
        error_of(text, "a.txt");
        if (i < whole.size()) text.erase(i + 1, 1);
        error_of(text, "a.txt");
      }
    }
}

TEST(LabelMap, AMillionLines) {
  std::string csv = "label,material,name,color\n", json = "{";
  for (std::uint64_t i = 1; i <= 1'000'000; ++i) {
    const std::uint64_t label = i * 7919 % 1'000'003;
    csv += fmt::format("{},{},segment {},#{:06x}\n", label, label % 1000, label, i);
    json += fmt::format("{}\"{}\": {{\"material\": {}, \"name\": \"segment {}\"}}",
                        i == 1 ? "" : ",\n", label, label % 1000, label);
  }
  for (const auto& [text, name] : {std::pair{csv, "a.csv"}, std::pair{json + "}", "a.json"}}) {
    const LabelMap map = parse(text, name);
    EXPECT_EQ(map.entries.size(), 1'000'000U);
    EXPECT_EQ(map.materials.entries.size(), 1000U);
    EXPECT_EQ(map.materials.find(77)->name, "segment 77");
  }
}

}  // namespace
}  // namespace voxweld
