// info and init of meshes that are to be the input.
#include <fstream>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

// A box from -1, 0, 2 to 3, 5, 4, as quads; without its top where it is open.
std::string box_obj(bool closed) {
  std::string text =
      "v -1 0 2\nv 3 0 2\nv 3 5 2\nv -1 5 2\nv -1 0 4\nv 3 0 4\nv 3 5 4\nv -1 5 4\n"
      "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  return closed ? text + "f 5 6 7 8\n" : text;
}

TEST(MeshFiles, InfoTellsWhatTheyHold) {
  const Workplace place;
  write_bytes(place.at("box.obj"), box_obj(true));
  const auto info = place.info(place.at("box.obj"));
  EXPECT_EQ(info.at("kind"), "input_mesh");
  EXPECT_EQ(info.at("format"), "obj");
  EXPECT_EQ(info.at("vertices"), 8);
  EXPECT_EQ(info.at("triangles"), 12);
  EXPECT_EQ(info.at("bounds").at("lo"), (nlohmann::json{-1, 0, 2}));
  EXPECT_EQ(info.at("size"), (nlohmann::json{4, 5, 2}));
  EXPECT_DOUBLE_EQ(info.at("volume").get<double>(), 40);
  EXPECT_EQ(info.at("closed"), true);
  EXPECT_EQ(info.at("holes"), 0);
  EXPECT_FALSE(info.contains("check"));
  EXPECT_EQ(place.info(place.at("box.obj"), {"--check"}).at("check").at("files"), 1);
}

TEST(MeshFiles, InfoTellsWhereTheyAreOpen) {
  const Workplace place;
  write_bytes(place.at("box.obj"), box_obj(false));
  const auto info = place.info(place.at("box.obj"));
  EXPECT_EQ(info.at("closed"), false);
  EXPECT_EQ(info.at("boundary_edges"), 4);
  EXPECT_EQ(info.at("holes"), 1);
  EXPECT_EQ(info.at("hole_list").at(0).at("edges"), 4);
  EXPECT_EQ(info.at("hole_list").at(0).at("center"), (nlohmann::json{1, 2.5, 4}));
  EXPECT_THAT(place.run({"info", place.at("box.obj")}).out, HasSubstr("closed          no\n"));
  expect_refused({"init", place.at("box.obj"), "-o", place.at("box.toml")},
                 {"box.obj: the mesh is not closed", "in 1 hole ("});
  EXPECT_THAT(place
                  .run({"init", place.at("box.obj"), "-o", place.at("box.toml"), "--close",
                        "winding", "--cell", "0.25"})
                  .out,
              HasSubstr("box.obj: 10 triangles, closed by winding number (obj)\n"));
  place.run({"run", place.at("box.toml")});
  place.run({"verify", place.at("box.mesh")});
  place.run({"export", place.at("box.mesh/mesh.drc"), "-o", place.at("out.off")});
  EXPECT_NEAR(place.info(place.at("out.off")).at("volume").get<double>(), 40, 0.1);
}

TEST(MeshFiles, InitLeadsToARunInTheirCoordinates) {
  const Workplace place;
  write_bytes(place.at("box.obj"), box_obj(true));
  const ProgramResult init = place.run({"init", place.at("box.obj"), "-o", place.at("box.toml"),
                                        "--resolution", "50", "--unit", "mm"});
  EXPECT_THAT(init.out, HasSubstr("box.obj: 12 triangles, closed (obj)\n"));
  EXPECT_THAT(init.out, HasSubstr("box.toml: 44 x 54 x 24 samples, 0.1 apart\n"));
  place.run({"run", place.at("box.toml")});
  place.run({"verify", place.at("box.mesh")});
  const auto bounds = place.info(place.at("box.mesh/mesh.drc")).at("bounds");
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    EXPECT_NEAR(bounds.at("lo").at(i).get<double>(), (std::array{-1, 0, 2})[i], 0.001);
    EXPECT_NEAR(bounds.at("hi").at(i).get<double>(), (std::array{3, 5, 4})[i], 0.001);
  }
  place.run({"export", place.at("box.mesh/mesh.glb"), "-o", place.at("out.stl")});
  const auto again = place.info(place.at("out.stl"));
  EXPECT_EQ(again.at("closed"), true);
  EXPECT_NEAR(again.at("volume").get<double>(), 40, 0.05);
  EXPECT_NEAR(again.at("bounds").at("lo").at(0).get<double>(), -1, 0.001);
}

TEST(MeshFiles, WhatInitRefuses) {
  const Workplace place;
  write_bytes(place.at("box.obj"), box_obj(true));
  const std::string mesh = place.at("box.obj"), config = place.at("c.toml");
  expect_refused({"init", mesh, "-o", config, "--cell", "100"},
                 {"the mesh is 5 across, 0.05 cells; expected at least 4 cells"});
  expect_refused({"init", mesh, "-o", config, "--spacing", "1"},
                 {"--spacing: a mesh has no samples; --cell says"});
  expect_refused({"init", place.phantom("scene.nrrd"), "-o", config, "--cell", "1"},
                 {"--cell: only meshes take it (.stl, .off, .obj, .ply)"});
}

}  // namespace
}  // namespace voxweld::testing
