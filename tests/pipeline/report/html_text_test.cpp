#include "pipeline/report/html_text.h"

#include <gtest/gtest.h>

#include <span>

namespace voxweld {
namespace {

TEST(HtmlText, EscapesWhatHtmlReads) {
  EXPECT_EQ(escaped("<b class=\"x\" id='y'> & co"),
            "&lt;b class=&quot;x&quot; id=&#39;y&#39;&gt; &amp; co");
  EXPECT_EQ(escaped("&amp;"), "&amp;amp;");
  EXPECT_EQ(escaped(""), "");
}

TEST(HtmlText, KeepsCharactersOfAllLengths) {
  const std::string text = "a\tb\nc \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x90\xB0";
  EXPECT_EQ(escaped(text), text);
}

TEST(HtmlText, ReplacesWhatNoPageMayHold) {
  const std::string r = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped(std::string("a\0b\x1B\x7F", 5)), "a" + r + "b" + r + r);
  EXPECT_EQ(escaped("\xFF"), r);
  EXPECT_EQ(escaped("\xC2\x80"), r);              // a control character
  EXPECT_EQ(escaped("\xC0\xAF"), r + r);          // too long for "/"
  EXPECT_EQ(escaped("\xED\xA0\x80"), r + r + r);  // half of a pair of UTF-16
  EXPECT_EQ(escaped("\xF4\x90\x80\x80"), r + r + r + r);
  EXPECT_EQ(escaped("\xE2\x82"), r + r);            // cut off
  EXPECT_EQ(escaped("\xE2<\x82"), r + "&lt;" + r);  // what follows is read by itself
}

std::string encoded(const std::string& text) {
  return base64(std::as_bytes(std::span(text.data(), text.size())));
}

TEST(HtmlText, Base64OfAllRests) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("\xFF\xFE\xFD"), "//79");
}

TEST(HtmlText, NumbersAsPeopleReadThem) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(grouped(1, "edges"), "1 edge");
  EXPECT_EQ(grouped(12345, "vertices"), "12,345 vertices");
  EXPECT_EQ(short_number(0.105112), "0.1051");
  EXPECT_EQ(short_number(-0.0), "0");
  EXPECT_EQ(short_number(-32767.5), "-32,768");
  EXPECT_EQ(short_number(1e20), "1e+20");
  EXPECT_EQ(with_unit(2.5, "mm"), "2.5 mm");
  EXPECT_EQ(with_unit(2.5, ""), "2.5");
  EXPECT_EQ(extent_text(Vec3{1, 2.5, 3}, "um"), "1 × 2.5 × 3 um");
  EXPECT_EQ(extent_text(Index3{1, 20, 300}), "1 × 20 × 300");
}

}  // namespace
}  // namespace voxweld
