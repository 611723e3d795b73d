#include "storage/support/text_fields.h"

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

TEST(TextFields, Numbers) {
  EXPECT_EQ(parse_integer("42"), 42);
  EXPECT_EQ(parse_integer("+42"), 42);
  EXPECT_EQ(parse_integer("-1"), -1);
  for (const char* bad : {"", "-", "+", "+-1", "4 2", "4.0", "0x10", "99999999999999999999"})
    EXPECT_FALSE(parse_integer(bad)) << bad;
  EXPECT_EQ(parse_real("4.000000e+000"), 4);
  EXPECT_EQ(parse_real("+.5"), 0.5);
  EXPECT_TRUE(std::isnan(*parse_real("nan")));
  for (const char* bad : {"", "1,5", "1e", "one"}) EXPECT_FALSE(parse_real(bad)) << bad;
}

TEST(TextFields, LinesAndTheirOffsets) {
  const TempDirectory directory;
  const std::string text = "one\r\n\n" + std::string(40000, 'x') + "\nlast";
  const ReadFile file(write_file(directory / "a", text));
  LineReader lines(file);
  EXPECT_EQ(lines.next(), "one");
  EXPECT_EQ(lines.offset(), 5U);
  EXPECT_EQ(lines.next(), "");
  EXPECT_EQ(lines.next()->size(), 40000U);
  EXPECT_EQ(lines.line_number(), 3);
  EXPECT_EQ(lines.offset(), 40007U);
  EXPECT_EQ(lines.next(), "last");
  EXPECT_FALSE(lines.next());
  EXPECT_EQ(lines.offset(), text.size());
}

std::vector<std::string> expand(const FilePattern& pattern, std::int64_t expected) {
  const HeaderFields fields("header");
  return expand_pattern(pattern, expected, fields, {"data file", pattern.pattern, 3});
}

TEST(TextFields, Patterns) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(expand({"a%d.raw", 9, 11, 1}, 3), (Names{"a9.raw", "a10.raw", "a11.raw"}));
  EXPECT_EQ(expand({"%03d", 8, 12, 2}, 3), (Names{"008", "010", "012"}));
  EXPECT_EQ(expand({"%2i-", 2, 0, -1}, 3), (Names{" 2-", " 1-", " 0-"}));
  for (const char* bad : {"a.raw", "%", "%s", "%d%d", "%n", "%-3d", "%999999999999d", "%03"})
    EXPECT_THROW(expand({bad, 1, 3, 1}, 3), FormatError) << bad;
  EXPECT_THROW(expand({"%d", 1, 3, 0}, 3), FormatError);
  EXPECT_THROW(expand({"%d", 1, 4, 1}, 3), FormatError);
  EXPECT_THROW(expand({"%d", 1, 3, -1}, 3), FormatError);
  EXPECT_THROW(expand({"%d", std::numeric_limits<std::int64_t>::min(),
                       std::numeric_limits<std::int64_t>::max(), 1},
                      3),
               FormatError);
}

TEST(TextFields, TellsAddressesFromPaths) {
  EXPECT_TRUE(is_url("https://example.org/a.zarr"));
  EXPECT_TRUE(is_url("HTTP://example.org"));
  for (const char* path : {"", "http", "http:/a", "/data/http://a", "s3://bucket/a", "httpd/a"})
    EXPECT_FALSE(is_url(path)) << path;
}

}  // namespace
}  // namespace voxweld::testing
