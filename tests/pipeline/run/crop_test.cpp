// A crop keeps the frame of its volume: coordinates, edits, the place in the world.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

using Places = std::set<std::array<float, 3>>;

// The vertices with from <= x < to.
Places places_of(const fs::path& output, double from, double to) {
  Places places;
  for (const auto& p : load_mesh(output / "mesh.drc").positions)
    if (static_cast<double>(p[0]) >= from && static_cast<double>(p[0]) < to) places.insert(p);
  return places;
}

constexpr Index3 whole_size = {44, 20, 18};
constexpr Vec3 spacing = {0.7, 0.9, 0.3};

// A wavy bar along x, turned and moved in the world.
fs::path write_bar(const fs::path& folder) {
  const RawVolume volume = volume_of(whole_size, [](Index3 p) {
    const std::int64_t y = 2 * p.y - 19 + p.x % 7, z = 2 * p.z - 17;
    return std::clamp<std::int64_t>(128 + 4 * (90 - y * y - z * z) / 9, 0, 255);
  });
  const fs::path path = folder / "bar.nrrd";
  std::ofstream out(path, std::ios::binary);
  out << fmt::format(
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {} {} {}\nencoding: raw\n"
      "space: left-posterior-superior\nspace directions: (0,{},0) (-{},0,0) (0,0,{})\n"
      "space origin: (-100.5,20.25,7)\n\n",
      whole_size.x, whole_size.y, whole_size.z, spacing.x, spacing.y, spacing.z);
  out.write(reinterpret_cast<const char*>(volume.samples.data()),
            static_cast<std::streamsize>(volume.samples.size()));
  return path;
}

class Crop : public ::testing::Test {
 protected:
  Crop() { write_bar(directory_.path()); }

  // Of the box from x0 to x1, with further settings of tables; the output directory.
  fs::path run(const std::string& name, std::int64_t x0, std::int64_t x1,
               const std::string& tables = {}, const std::string& copy = "\"auto\"") const {
    const fs::path config = directory_ / (name + ".toml");
    std::ofstream(config) << fmt::format(
        "[input]\npath = \"bar.nrrd\"\ncrop = [{}, 0, 0, {}, {}, {}]\n[surface]\nisovalue = 128\n"
        "border = \"open\"\n[simplify]\nenabled = false\n[work]\ncopy = {}\n{}",
        x0, x1, whole_size.y, whole_size.z, copy, tables);
    const ProgramResult result = run_voxweld({"run", config.string()});
    VOXWELD_EXPECT_DONE(result);
    messages_ = result.err;
    expect_good(directory_ / (name + ".mesh"));
    return directory_ / (name + ".mesh");
  }

  TempDirectory directory_;
  mutable std::string messages_;
};

// Put together, the meshes of two crops that overlap have the vertices of the whole volume's mesh,
// in the coordinates of the files, and so in the world, whose transform is the same.
TEST_F(Crop, TwoCropsFitTogetherInFileAndWorldCoordinates) {
  const double seam = 20.5 * spacing.x, end = 1000;
  const fs::path whole = run("whole", 0, whole_size.x), low = run("low", 0, 26),
                 high = run("high", 14, 44);
  Places both = places_of(low, -end, seam);
  both.merge(places_of(high, seam, end));
  EXPECT_GT(both.size(), 1000U);
  EXPECT_EQ(both, places_of(whole, -end, end));

  const auto frame = manifest_of(whole).at("frame"), of_high = manifest_of(high).at("frame");
  EXPECT_EQ(of_high.at("origin"), (nlohmann::json{-100.5, 20.25, 7.0}));
  EXPECT_EQ(of_high.at("origin"), frame.at("origin"));
  EXPECT_EQ(of_high.at("direction"), frame.at("direction"));
  EXPECT_EQ(of_high.at("first"), (nlohmann::json{14 * spacing.x, 0.0, 0.0}));
  EXPECT_EQ(of_high.at("size"), (nlohmann::json{30, whole_size.y, whole_size.z}));
  // The transform of a .glb's node is made of origin and direction.
  const auto node = [](const fs::path& output) {
    const std::string text = text_of_file(output / "mesh.glb");
    std::uint32_t length = 0;
    std::memcpy(&length, text.data() + 12, 4);
    return nlohmann::json::parse(text.substr(20, length)).at("nodes").at(0).at("matrix");
  };
  EXPECT_EQ(node(high), node(whole));
}

// The brick store of a crop says the same.
TEST_F(Crop, ACopyChangesNothing) {
  const fs::path read = run("read", 14, 44), copied = run("copied", 14, 44, {}, "true");
  EXPECT_EQ(difference(output_tree(read), output_tree(copied)), "");
}

TEST_F(Crop, EditsStayWhereTheyAreInTheWholeVolume) {
  const std::string edit =
      "[[edit]]\nop = \"subtract\"\nshape = \"sphere\"\ncenter = [21, 8.5, 2.5]\nradius = 2.25\n";
  const double from = 17 * spacing.x, end = 1000;
  const fs::path whole = run("whole", 0, whole_size.x, edit), part = run("part", 14, 44, edit);
  const Places expected = places_of(whole, from, end), found = places_of(part, from, end);
  EXPECT_EQ(found, expected);
  EXPECT_NE(expected, places_of(run("plain", 0, whole_size.x), from, end));
}

TEST(FarCrop, WhatFloatsCannotHoldIsInTheOriginAndSaidSo) {
  const Scene scene(volume_of({560, 9, 9}, [](Index3 p) {
    const Index3 d = p - Index3{540, 4, 4};
    return std::clamp<std::int64_t>(200 - 10 * (d.x * d.x + d.y * d.y + d.z * d.z), 0, 255);
  }));
  const ProgramResult result =
      scene.run({"input.crop=[530, 0, 0, 550, 9, 9]", "output.precision=0.00004"});
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, "floats do not hold the whole volume's coordinates");
  expect_says(result, "less by [530, 0, 0]");
  const auto frame = manifest_of(scene.output()).at("frame");
  EXPECT_EQ(frame.at("first"), (nlohmann::json{0.0, 0.0, 0.0}));
  EXPECT_EQ(frame.at("origin"), (nlohmann::json{530.0, 0.0, 0.0}));
  expect_good(scene.output());
}

}  // namespace
}  // namespace voxweld::testing
