#include "stages/encode/mesh_writers.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/shapes.h"

namespace voxweld {
namespace {

std::vector<std::byte> written(const MeshWriter& writer, Asset& asset) {
  std::vector<std::byte> file;
  writer.write(asset, [&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
  });
  return file;
}

TEST(MeshWriters, EachReadsWhatItWrote) {
  const TileMesh mesh = testing::make_torus({}, testing::small_lattice());
  const AssetFacts facts;
  for (const MeshWriter& writer : mesh_writers()) {
    Asset asset(mesh, facts);
    const DecodedMesh read = writer.read(written(writer, asset), "file");
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size()) << writer.name;
  }
}

TEST(MeshWriters, FormatsOfOneMeshShareTheEncodedOne) {
  const TileMesh mesh = testing::make_torus({}, testing::small_lattice());
  const AssetFacts facts;
  Asset asset(mesh, facts);
  const EncodedMesh* encoded = &asset.encoded();
  const std::byte* bytes = encoded->bytes.data();
  for (const MeshWriter& writer : mesh_writers()) written(writer, asset);
  EXPECT_EQ(&asset.encoded(), encoded);
  EXPECT_EQ(asset.encoded().bytes.data(), bytes);
}

TEST(MeshWriters, NoTwoHaveANameOrAnEndingInCommon) {
  std::set<std::string_view> names, endings;
  for (const MeshWriter& writer : mesh_writers()) {
    EXPECT_TRUE(names.insert(writer.name).second);
    EXPECT_TRUE(endings.insert(writer.ending).second);
  }
}

TEST(MeshWriters, AreChosenInTheOrderOfTheTable) {
  const std::vector<std::string> names = {"glb", "drc"};
  const std::vector<MeshWriter> chosen = writers_named(mesh_writers(), names);
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_EQ(chosen[0].name, "drc");
  EXPECT_EQ(chosen[1].name, "glb");
  EXPECT_EQ(writer_named(mesh_writers(), "gltf"), nullptr);
}

TEST(MeshWriters, AreKnownByTheLongestEndingOfAFile) {
  const auto named = [](std::string_view file) {
    const MeshWriter* const writer = writer_of_file(mesh_writers(), file);
    return writer == nullptr ? "none" : writer->name;
  };
  EXPECT_EQ(named("mesh.glb"), "glb");
  EXPECT_EQ(named("mesh.plain.glb"), "glb-plain");
  EXPECT_EQ(named("plain.glb"), "glb");
  EXPECT_EQ(named("mesh.meshopt.glb"), "meshopt");
  EXPECT_EQ(named("a.b.ply"), "ply");
  EXPECT_EQ(named("mesh.vtp"), "vtp");
  EXPECT_EQ(named("drc"), "none");
}

}  // namespace
}  // namespace voxweld
