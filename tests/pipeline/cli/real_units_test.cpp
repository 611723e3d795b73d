// Files with a slope and an intercept: whatever a user types or reads is real, such as HU.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int side = 24;

// A ball of 1000 in 200, blurred over a few samples, as the file stores it.
std::vector<std::int16_t> scaled_ball() {
  std::vector<std::int16_t> samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double dx = x - 11.3, dy = y - 11.7, dz = z - 12.1;
        const double d = std::sqrt(dx * dx + dy * dy + dz * dz) - 8;
        samples.push_back(static_cast<std::int16_t>(600 - 150 * std::clamp(d, -2.6, 2.6)));
      }
  return samples;
}

void write_nifti(const std::string& path, float slope, float intercept) {
  std::string bytes(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  put(0, std::int32_t{348});
  const std::int16_t dim[] = {3, side, side, side, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) put(40 + 2 * i, dim[i]);
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  for (std::size_t i = 0; i < 4; ++i) put(76 + 4 * i, 1.0F);
  put(108, 352.0F);
  put(112, slope);
  put(116, intercept);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  const auto samples = scaled_ball();
  bytes.append(reinterpret_cast<const char*>(samples.data()), 2 * samples.size());
  write_bytes(path, bytes);
}

struct Result {
  std::string mesh, err;
  nlohmann::json manifest;
};

class RealUnits : public ::testing::Test {
 protected:
  Result run(const std::string& name, float slope, float intercept, const std::string& surface,
             const std::vector<std::string>& settings = {}) const {
    write_nifti(place.at(name + ".nii"), slope, intercept);
    write_bytes(place.at(name + ".toml"),
                "[input]\npath = \"" + name + ".nii\"\n[surface]\n" + surface);
    std::vector<std::string> arguments = {"run", place.at(name + ".toml")};
    for (const std::string& setting : settings) {
      arguments.push_back("--set");
      arguments.push_back(setting);
    }
    const ProgramResult result = place.run(arguments);
    return {read_bytes(place.at(name + ".mesh/mesh.drc")), result.err,
            nlohmann::json::parse(read_bytes(place.at(name + ".mesh/manifest.json")))};
  }
  Workplace place;
};

TEST_F(RealUnits, IsovaluesAreReal) {
  const Result stored = run("plain", 0, 0, "isovalue = 599.5\n");
  EXPECT_FALSE(stored.manifest.at("input").contains("slope"));
  const Result scaled = run("scaled", 2, -1024, "isovalue = 175.0\n");
  EXPECT_EQ(scaled.mesh, stored.mesh);
  EXPECT_THAT(scaled.err, Not(HasSubstr("warning")));
  EXPECT_EQ(scaled.manifest.at("input").at("slope"), 2);
  EXPECT_EQ(scaled.manifest.at("input").at("intercept"), -1024);
  // Through a copy, which has its own account of the file.
  EXPECT_EQ(run("copied", 2, -1024, "isovalue = 175.0\n", {"work.copy=true"}).mesh, stored.mesh);
  // A slope below zero turns above and below around.
  EXPECT_EQ(run("turned", -2, 1024, "isovalue = -175.0\ninside = \"below\"\n").mesh, stored.mesh);
}

TEST_F(RealUnits, OfAChangedHeaderTheMeshIsMadeAgain) {
  const Result before = run("scan", 2, -1024, "isovalue = 175.0\n");
  EXPECT_NE(run("scan", 1, -1024, "isovalue = -600.0\n").mesh, before.mesh);
  EXPECT_EQ(run("scan", 2, -1024, "isovalue = 175.0\n").mesh, before.mesh);
}

TEST_F(RealUnits, WhatIsSaidIsReal) {
  write_nifti(place.at("scan.nii"), -2, 1000);
  const nlohmann::json info = place.info(place.at("scan.nii"));
  EXPECT_EQ(info.at("slope"), -2);
  EXPECT_EQ(info.at("intercept"), 1000);
  const nlohmann::json& values = info.at("values");
  EXPECT_EQ(values.at("range"), nlohmann::json({-980, 580}));
  EXPECT_EQ(values.at("quantiles").at("99%"), 580);
  EXPECT_LT(values.at("quantiles").at("1%"), -900);
  const double suggested = values.at("suggested_isovalue").at("value");
  EXPECT_GT(suggested, -900);
  EXPECT_LT(suggested, 500);
  const ProgramResult init = place.run({"init", place.at("scan.nii"), "-o", place.at("scan.toml")});
  EXPECT_THAT(init.out, HasSubstr("samples -980 to 580"));
  const std::string config = read_bytes(place.at("scan.toml"));
  EXPECT_THAT(config, HasSubstr("-2.0 * stored + 1000.0"));
  EXPECT_THAT(config, HasSubstr("inside = \"below\""));
  const nlohmann::json surface = place.info(place.at("scan.toml")).at("settings").at("surface");
  EXPECT_EQ(surface.at("isovalue"), suggested);
  place.run(
      {"run", place.at("scan.toml"), "--log-level", "quiet", "--set", "surface.isovalue=otsu"});
  place.run({"verify", place.at("scan.mesh")});
  expect_refused(
      {"run", place.at("scan.toml"), "--log-level", "quiet", "--set", "surface.isovalue=-2000"},
      {"isovalue = -2000", "from -980 to 580"});
}

TEST_F(RealUnits, LabelsOfAScaledFileAreRefused) {
  write_nifti(place.at("scan.nii"), 1, -200);
  const std::string input = "[input]\npath = \"scan.nii\"\n";
  write_bytes(place.at("one.toml"), input + "[surface]\nlabel = 7\n");
  expect_refused({"run", place.at("one.toml")},
                 {"surface.label = 7", "scan.nii", "1 * stored + -200", "surface.isovalue"});
  write_bytes(place.at("each.toml"), input + "[labels]\nmode = \"each\"\n");
  expect_refused({"run", place.at("each.toml")}, {"labels.mode", "1 * stored + -200"});
  expect_refused({"init", place.at("scan.nii"), "--labels", "-o", place.at("a.toml")},
                 {"--labels", "1 * stored + -200"});
}

// Two neighbours that no double tells apart.
TEST(LargeIsovalueRun, TellsNeighboursBeyond2To53Apart) {
  const Workplace place;
  constexpr int n = 12;
  std::string bytes;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const int d = (x - 5) * (x - 5) + (y - 5) * (y - 5) + (z - 6) * (z - 6);
        const std::uint64_t v = (std::uint64_t{1} << 63) + static_cast<std::uint64_t>(200 - d);
        bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
      }
  write_bytes(place.at("large.raw"), bytes);
  const std::string input =
      "[input]\npath = \"large.raw\"\nformat = \"raw\"\nsize = [12, 12, 12]\ntype = \"uint64\"\n"
      "[surface]\n";
  write_bytes(place.at("a.toml"), input + "isovalue = \"9223372036854775992\"\n");  // 2^63 + 184
  place.run({"run", place.at("a.toml")});
  place.run({"verify", place.at("a.mesh")});
  const nlohmann::json counts =
      nlohmann::json::parse(read_bytes(place.at("a.mesh/manifest.json"))).at("counts");
  EXPECT_GT(counts.at("vertices"), 50);
  expect_refused({"run", place.at("a.toml"), "--log-level", "quiet", "--set",
                  "surface.isovalue=9223372036854776009"},
                 {"surface.isovalue = 9223372036854776009", "no sample is at or above"});
  expect_refused(
      {"run", place.at("a.toml"), "--log-level", "quiet", "--set", "surface.isovalue=otsu"},
      {"too close together for a histogram", "from 9223372036854775808 to"});
  write_bytes(place.at("b.toml"), input + "label = \"9223372036854776007\"\n");  // 2^63 + 199
  place.run({"run", place.at("b.toml")});
  place.run({"verify", place.at("b.mesh")});
}

}  // namespace
}  // namespace voxweld::testing
