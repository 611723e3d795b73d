// voxweld histogram: text, JSON and a picture.
#include <algorithm>
#include <sstream>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Seventy samples of 10, thirty of 12, fifty of 200, ten of 90, and one of 255, as text.
std::string write_scan(const Workplace& place, const std::string& header = "") {
  std::string text =
      "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 7 23 1\nencoding: ascii\n" + header + "\n";
  const std::pair<int, int> counts[] = {{10, 70}, {12, 30}, {200, 50}, {90, 10}, {255, 1}};
  for (const auto& [value, count] : counts)
    for (int i = 0; i < count; ++i) text += std::to_string(value) + " ";
  write_bytes(place.at("scan.nrrd"), text);
  return place.at("scan.nrrd");
}

TEST(HistogramCommand, WritesJson) {
  const Workplace place;
  const std::string scan = write_scan(place), out = place.at("h.json");
  place.run({"histogram", scan, "-o", out, "--range", "0", "255"});
  const auto json = nlohmann::json::parse(read_bytes(out));
  EXPECT_EQ(json["samples"], 161);
  EXPECT_EQ(json["range"], (std::vector<double>{10, 255}));
  const auto& cells = json["cells"];
  EXPECT_EQ(cells["begin"], -0.5);
  EXPECT_EQ(cells["width"], 1);
  ASSERT_EQ(cells["counts"].size(), 256U);
  EXPECT_EQ(cells["counts"][10], 70);
  EXPECT_EQ(cells["counts"][200], 50);
  EXPECT_EQ(cells["counts"][255], 1);
  EXPECT_EQ(cells["below"], 0);
  EXPECT_GT(json["otsu"]["value"], 90);
  EXPECT_LT(json["otsu"]["value"], 200);
  EXPECT_GT(json["valley"]["value"], 10);
  EXPECT_LT(json["valley"]["value"], 200);
  EXPECT_TRUE(json["padding"].is_null());
}

TEST(HistogramCommand, CountsWhatLiesOutsideTheRange) {
  const Workplace place;
  const std::string scan = write_scan(place), out = place.at("h.json");
  place.run({"histogram", scan, "-o", out, "--range", "50", "220", "--bins", "10"});
  const auto cells = nlohmann::json::parse(read_bytes(out))["cells"];
  EXPECT_EQ(cells["below"], 100);
  EXPECT_EQ(cells["above"], 1);
  double inside = 0;
  for (const auto& count : cells["counts"]) inside += count.get<double>();
  EXPECT_NEAR(inside, 60, 1e-9);
  EXPECT_LE(cells["counts"].size(), 10U);
}

TEST(HistogramCommand, PrintsALineForEachBar) {
  const Workplace place;
  const std::string text = place.run({"histogram", write_scan(place)}).out;
  EXPECT_THAT(text, HasSubstr("7 x 23 x 1 uint8, values 10 to 255"));
  EXPECT_THAT(text, HasSubstr("< otsu"));
  EXPECT_THAT(text, HasSubstr("< valley"));
  const auto bars = std::ranges::count(text, '|');
  EXPECT_GE(bars, 20);
  EXPECT_LE(bars, 32);
}

TEST(HistogramCommand, DrawsAPicture) {
  const Workplace place;
  const std::string out = place.at("h.png");
  place.run({"histogram", write_scan(place), "-o", out});
  const std::string png = read_bytes(out);
  ASSERT_GT(png.size(), 1000U);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\4\0\0\0\1\xe0", 8));  // 1024 x 480
}

TEST(HistogramCommand, RefusesWhatItCannotWrite) {
  const Workplace place;
  const std::string scan = write_scan(place);
  expect_refused({"histogram", scan, "-o", place.at("h.txt")}, {"h.txt", ".png", ".json"});
  write_bytes(place.at("there.json"), "{}");
  expect_refused({"histogram", scan, "-o", place.at("there.json")}, {"there.json", "--force"});
  expect_refused({"histogram", scan, "--range", "9", "9"}, {"--range", "lower one first"});
}

// Of a volume of one value there is nothing to choose, yet something to show.
TEST(HistogramCommand, OfOneValue) {
  const Workplace place;
  write_bytes(place.at("flat.nrrd"),
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n"
              "7 7 7 7 7 7 7 7");
  const std::string text = place.run({"histogram", place.at("flat.nrrd")}).out;
  EXPECT_THAT(text, HasSubstr("# 8\n"));
  EXPECT_THAT(text, Not(HasSubstr("otsu")));
}

TEST(HistogramCommand, ValleyIsAnIsovalueOfARun) {
  const Workplace place;
  const std::string volume = place.phantom("ball.nrrd");
  place.run({"init", volume, "-o", place.at("a.toml")});
  const auto run = place.run({"run", place.at("a.toml"), "--set", "surface.isovalue=valley"});
  EXPECT_THAT(run.err, HasSubstr("surface.isovalue = \"valley\": "));
}

}  // namespace
}  // namespace voxweld::testing
