#include "stages/encode/glb.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "stages/encode/corner_points.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using nlohmann::json;

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

json json_of(std::span<const std::byte> glb) {
  const auto text = glb.subspan(20, u32(glb, 12));
  return json::parse(std::string(reinterpret_cast<const char*>(text.data()), text.size()));
}

EncodedMesh torus(bool normals = true) {
  return encode_draco(testing::make_torus({}, testing::small_lattice()), {.normals = normals});
}

VolumeGeometry scanner_frame() {
  VolumeGeometry frame;
  frame.origin = {10, 20, 30};
  frame.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
  frame.unit = "mm";
  return frame;
}

TEST(Glb, HasTheStructureTheSpecificationAsksFor) {
  const EncodedMesh mesh = torus();
  const auto glb = wrap_glb(mesh, {});
  EXPECT_EQ(u32(glb, 0), 0x46546c67u);
  EXPECT_EQ(u32(glb, 4), 2u);
  EXPECT_EQ(u32(glb, 8), glb.size());
  EXPECT_EQ(glb.size() % 4, 0u);
  EXPECT_EQ(u32(glb, 12) % 4, 0u);
  const json doc = json_of(glb);
  EXPECT_EQ(doc["asset"]["version"], "2.0");
  EXPECT_EQ(doc["extensionsUsed"], json::array({"KHR_draco_mesh_compression"}));
  EXPECT_EQ(doc["extensionsRequired"], doc["extensionsUsed"]);
  const json& primitive = doc["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 4);
  const json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
  EXPECT_EQ(extension["bufferView"], 0);
  EXPECT_EQ(extension["attributes"]["POSITION"], mesh.position_id);
  EXPECT_EQ(extension["attributes"]["NORMAL"], mesh.normal_id);
  EXPECT_EQ(doc["materials"][0]["doubleSided"], false);
  for (const json& accessor : doc["accessors"]) EXPECT_FALSE(accessor.contains("bufferView"));
  EXPECT_EQ(doc["bufferViews"][0]["byteLength"], mesh.bytes.size());
}

TEST(Glb, AccessorsStateWhatDecodes) {
  for (const bool normals : {false, true}) {
    const EncodedMesh mesh = torus(normals);
    const auto glb = wrap_glb(mesh, {});
    const DecodedMesh decoded = decode_glb(glb);  // compares counts, min and max
    EXPECT_EQ(decoded.triangles.size(), mesh.triangles);
    EXPECT_EQ(decoded.normals.empty(), !normals);
    const json doc = json_of(glb);
    EXPECT_EQ(doc["accessors"].size(), normals ? 3u : 2u);
    EXPECT_EQ(doc["accessors"][0]["count"], decoded.positions.size());
  }
}

TEST(Glb, HoldsTheVeryDracoBuffer) {
  const EncodedMesh mesh = torus();
  const auto glb = wrap_glb(mesh, {});
  EXPECT_EQ(json_of(glb)["bufferViews"][0].value("byteOffset", 0), 0);
  const auto inner = std::span(glb).subspan(20 + u32(glb, 12) + 8, mesh.bytes.size());
  EXPECT_TRUE(std::ranges::equal(inner, mesh.bytes));
}

TEST(Glb, NodeCarriesFrameUnitAndUpAxis) {
  const auto matrix = [](const GlbParameters& parameters) {
    const json doc = json_of(wrap_glb(torus(), parameters));
    return doc["nodes"][0].value("matrix", std::vector<double>{});
  };
  EXPECT_EQ(matrix({.frame = {}, .y_up = false}), std::vector<double>{});
  EXPECT_EQ(matrix({}), (std::vector<double>{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}));
  // Index axis 0 points along world y, which is glTF's -z; in metres.
  const auto m = matrix({.frame = scanner_frame()});
  const std::vector<double> expected{0, 0,    -1e-3, 0, -1e-3, 0,    0,     0,
                                     0, 1e-3, 0,     0, 0.01,  0.03, -0.02, 1};
  ASSERT_EQ(m.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(m[i], expected[i], 1e-15) << i;
}

TEST(Glb, ShearedFramesAreStatedNotApplied) {
  VolumeGeometry frame = scanner_frame();
  frame.direction[0] = {0.6, 0.8, 0};
  const json doc = json_of(wrap_glb(torus(), {.frame = frame, .y_up = false}));
  EXPECT_EQ(doc["nodes"][0]["extras"]["direction"][0], (std::vector<double>{0.6, 0.8, 0}));
  EXPECT_EQ(doc["nodes"][0]["matrix"][1], 0);
}

TEST(Glb, RefusesEveryTruncation) {
  const auto glb = wrap_glb(torus(), {});
  for (std::size_t size = 0; size < glb.size(); ++size)
    EXPECT_THROW(decode_glb(std::span(glb).first(size)), FormatError) << size;
}

TEST(Glb, SurvivesFlippedBits) {
  const auto glb = wrap_glb(torus(false), {});
  for (std::size_t at = 0; at < glb.size(); ++at) {
    for (const int bit : {0, 3, 5, 7}) {
      auto flipped = glb;
      flipped[at] ^= static_cast<std::byte>(1 << bit);
      try {
        decode_glb(flipped, "a.glb");
      } catch (const FormatError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("a.glb: ", 0), 0u);
      }
    }
  }
}

TEST(Glb, RefusesCountsThatDoNotDecode) {
  EncodedMesh mesh = torus();
  ++mesh.points;
  EXPECT_THROW(decode_glb(wrap_glb(mesh, {})), FormatError);
  mesh = torus();
  mesh.hi[1] += 1;
  EXPECT_THROW(decode_glb(wrap_glb(mesh, {})), FormatError);
}

std::vector<std::byte> plain(bool normals, const GlbParameters& parameters = {}) {
  const TileMesh mesh = testing::make_torus({}, testing::small_lattice());
  std::vector<std::byte> glb;
  write_plain_glb(corner_points(mesh, normals), parameters, [&](std::span<const std::byte> bytes) {
    glb.insert(glb.end(), bytes.begin(), bytes.end());
  });
  return glb;
}

TEST(PlainGlb, NamesNoExtensionAndIsReadAsItWasWritten) {
  const TileMesh mesh = testing::make_torus({}, testing::small_lattice());
  for (const bool normals : {false, true}) {
    const auto glb = plain(normals);
    EXPECT_EQ(u32(glb, 8), glb.size());
    EXPECT_EQ(glb.size() % 4, 0u);
    const json doc = json_of(glb);
    EXPECT_FALSE(doc.contains("extensionsUsed"));
    EXPECT_FALSE(doc.contains("extensionsRequired"));
    for (const json& accessor : doc["accessors"]) EXPECT_TRUE(accessor.contains("bufferView"));
    const DecodedMesh read = decode_glb(glb), points = corner_points(mesh, normals);
    EXPECT_EQ(read.positions, points.positions);
    EXPECT_EQ(read.normals, points.normals);
    EXPECT_EQ(read.triangles, points.triangles);
  }
}

TEST(PlainGlb, RefusesDamage) {
  const auto glb = plain(true);
  for (std::size_t size = 0; size < glb.size(); size += 7)
    EXPECT_THROW(decode_glb(std::span(glb).first(size)), FormatError) << size;
  for (std::size_t at = 0; at < glb.size(); ++at) {
    auto flipped = glb;
    flipped[at] ^= std::byte{32};
    try {
      decode_glb(flipped, "a.glb");
    } catch (const FormatError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("a.glb: ", 0), 0u);
    }
  }
}

// The Khronos validator, where tests/npm_packages.sh has installed it.
TEST(Glb, PassesTheKhronosValidator) {
  const std::string script = VOXWELD_GLTF_VALIDATE;
  if (std::system(("node " + script + " > /dev/null 2>&1").c_str()) != 0)
    GTEST_SKIP() << "gltf-validator is not installed; run tests/npm_packages.sh";
  const testing::TempDirectory directory;
  std::string files;
  const GlbParameters variants[] = {{}, {.frame = scanner_frame()}, {.frame = {}, .y_up = false}};
  for (const GlbParameters& variant : variants) {
    for (const bool normals : {false, true}) {
      const auto path = directory / fmt::format("a{}.glb", files.size());
      write_whole_file(path, wrap_glb(torus(normals), variant), Durability::rename_only);
      files += fmt::format(" {}", path.string());
      const auto other = directory / fmt::format("b{}.glb", files.size());
      write_whole_file(other, plain(normals, variant), Durability::rename_only);
      files += fmt::format(" {}", other.string());
    }
  }
  EXPECT_EQ(std::system(fmt::format("node {}{}", script, files).c_str()), 0);
}

}  // namespace
}  // namespace voxweld
