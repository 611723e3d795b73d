// Configs whose input is a mesh: how they are told, and what does not go with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::parse;
using ::testing::StartsWith;

std::string mesh_config(const std::string& more = {}) {
  return "input.path = \"part.stl\"\ninput.resolution = 100\n" + more;
}

TEST(MeshConfig, KnownByItsName) {
  const Config config = parse(mesh_config());
  EXPECT_EQ(config.input.format, "mesh");
  EXPECT_EQ(config.input.resolution, 100);
  EXPECT_EQ(config.input.cell, std::nullopt);
  EXPECT_EQ(config.input.margin, 1);
  EXPECT_EQ(config.input.close, MeshClosing::no);
  EXPECT_EQ(parse(mesh_config("input.close = \"winding\"\n")).input.close, MeshClosing::winding);
  EXPECT_TRUE(config.surface.isovalue.has_value());
  for (const char* name : {"a.STL", "a.off", "a.Obj", "a.ply"})
    EXPECT_EQ(parse(mesh_config(), {std::string("input.path=") + name}).input.format, "mesh");
  EXPECT_EQ(parse("input.path = \"part\"\ninput.format = \"mesh\"\ninput.cell = 0.5\n").input.cell,
            0.5);
  // A format that is given is taken.
  EXPECT_EQ(
      parse("input.path = \"a.off\"\ninput.format = \"nrrd\"\nsurface.isovalue = 1\n").input.format,
      "nrrd");
}

TEST(MeshConfig, ResolutionOrCellAndNotBoth) {
  EXPECT_EQ(error_of("input.path = \"part.stl\"\n"),
            "/data/scan.toml:1:14: input.resolution: missing, and a mesh needs it, or input.cell: "
            "expected an integer from 4 to 524280");
  EXPECT_EQ(
      error_of(mesh_config("input.cell = 0.5\n")),
      "/data/scan.toml:2:20: input.resolution = 100: input.cell says the same in another way; "
      "remove one of the two");
}

TEST(MeshConfig, WhatVolumesTakeMeshesDoNot) {
  const std::pair<const char*, const char*> wrong[] = {{"input.crop", "[0, 0, 0, 8, 8, 8]"},
                                                       {"input.spacing", "1"},
                                                       {"input.size", "[8, 8, 8]"},
                                                       {"input.type", "\"int8\""},
                                                       {"input.endian", "\"big\""},
                                                       {"input.header_bytes", "4"},
                                                       {"input.follow", "true"},
                                                       {"input.dataset", "\"data\""},
                                                       {"input.series", "\"1.2.3\""},
                                                       {"input.level", "1"},
                                                       {"input.channel", "0"},
                                                       {"input.time", "2"},
                                                       {"input.resample", "\"uniform\""}};
  for (const auto& [key, value] : wrong) {
    const std::string message = error_of(mesh_config(std::string(key) + " = " + value + "\n"));
    EXPECT_THAT(message, StartsWith("/data/scan.toml:3:"));
    EXPECT_THAT(message, HasSubstr(std::string(key) + " = "));
    EXPECT_THAT(message, HasSubstr("a mesh has no samples; remove it: input.resolution or"));
  }
  const std::pair<const char*, const char*> surface[] = {{"surface.isovalue", "1"},
                                                         {"surface.isovalue", "\"otsu\""},
                                                         {"surface.label", "1"},
                                                         {"surface.inside", "\"below\""},
                                                         {"surface.gradient", "\"central\""}};
  for (const auto& [key, value] : surface)
    EXPECT_THAT(error_of(mesh_config(std::string(key) + " = " + value + "\n")),
                HasSubstr("a mesh is its own surface, with its own normals; remove it"));
}

TEST(MeshConfig, WhatMeshesTakeVolumesDoNot) {
  for (const std::string key : {"input.resolution = 9", "input.cell = 2", "input.margin = 2",
                                "input.close = \"winding\""}) {
    const std::string message = error_of(testing::least_config(key + "\n"));
    EXPECT_THAT(message, StartsWith("/data/scan.toml:3:"));
    EXPECT_THAT(message,
                HasSubstr("only meshes take it; remove it, or name an .stl, .off, .obj or"));
  }
}

}  // namespace
}  // namespace voxweld
