// A format of the test's own: all that is known of it is one row of the type of the table.
#include "stages/encode/mesh_writers.h"

#include <gmock/gmock.h>

#include <cstring>

#include "pipeline/output/load.h"
#include "pipeline/output/verify.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/encode/encoded_scene.h"

namespace voxweld {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

// Nine floats a triangle, and nothing else.
using Corners = std::array<std::array<float, 3>, 3>;

void write_soup(Asset& asset, const ByteSink& sink) {
  const TileMesh& mesh = asset.mesh();
  for (const auto& triangle : mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        corners[k][axis] = static_cast<float>(
            mesh.lattice.coordinate(static_cast<int>(axis), mesh.positions[triangle[k]][axis]));
    sink(std::as_bytes(std::span(&corners, 1)));
  }
}

DecodedMesh read_soup(std::span<const std::byte> file, const std::string& where) {
  if (file.size() % sizeof(Corners) != 0) throw FormatError(where + ": half a triangle");
  DecodedMesh mesh;
  for (std::size_t at = 0; at < file.size(); at += sizeof(Corners)) {
    Corners corners;
    std::memcpy(&corners, &file[at], sizeof corners);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

constexpr MeshWriter soup{"soup", ".tri", false, 0, write_soup, read_soup};

class OwnFormat : public ::testing::Test {
 protected:
  void encode(std::vector<MeshWriter> formats) {
    formats_ = std::move(formats);
    EncodeJob job = scene_.job("own");
    job.formats = formats_;
    job.key = {++times_, 0};  // formats are of the config, and so of the key
    scene_.encode(job);
  }
  std::filesystem::path output() const { return scene_.output("own"); }
  VerifyReport verify() const { return verify_output(output(), {.formats = formats_}); }

  testing::EncodedScene scene_{{"output.tile_vertices=1024", "simplify.enabled=false"}};
  std::vector<MeshWriter> formats_;
  std::uint64_t times_ = 0;
};

TEST_F(OwnFormat, IsEncodedListedVerifiedAndReadBack) {
  encode({soup});
  const Manifest manifest = read_manifest(output() / manifest_name);
  ASSERT_TRUE(manifest.merged);
  EXPECT_THAT(*manifest.merged, ElementsAre(Pair("soup", "mesh.tri")));
  EXPECT_EQ(manifest.counts.files, manifest.counts.tiles + 1);
  EXPECT_GT(manifest.counts.tiles, 1u);

  const VerifyReport report = verify();
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_TRUE(report.merged_checked);
  EXPECT_EQ(report.triangles, manifest.counts.triangles);

  std::uint64_t triangles = 0;
  for_each_mesh(
      output(), [&](const DecodedMesh& mesh, auto) { triangles += mesh.triangles.size(); },
      formats_);
  EXPECT_EQ(triangles, report.triangles);
  EXPECT_EQ(load_mesh(output() / "mesh.tri", formats_).triangles.size(), report.triangles);
}

TEST_F(OwnFormat, IsComparedWithTheOthersOfTheSameMesh) {
  encode({mesh_writers()[0], soup});
  EXPECT_TRUE(verify().good());
  // As many bytes and a hash that is listed, but another mesh: a writer that loses a triangle.
  encode({mesh_writers()[0],
          {"soup", ".tri", false, 0,
           [](Asset& asset, const ByteSink& sink) {
             TileMesh mesh = asset.mesh();
             mesh.triangles.pop_back();
             Asset less(mesh, asset.facts());
             write_soup(less, sink);
           },
           read_soup}});
  const VerifyReport report = verify();
  EXPECT_FALSE(report.good());
  EXPECT_THAT(to_text(report), HasSubstr("its triangles differ from those of tiles/"));
}

TEST_F(OwnFormat, LeavesNoFilesOfTheFormatsBefore) {
  encode({mesh_writers()[0], mesh_writers()[1]});
  EXPECT_TRUE(std::filesystem::exists(output() / "mesh.glb"));
  encode({soup});
  EXPECT_FALSE(std::filesystem::exists(output() / "mesh.glb"));
  EXPECT_TRUE(verify().good());
}

TEST_F(OwnFormat, IsUnknownToTheTableOfTheProgram) {
  encode({soup});
  EXPECT_THAT(to_text(verify_output(output())), HasSubstr("lists no file of a known format"));
  EXPECT_THROW(load_mesh(output() / "mesh.tri"), InputError);
}

}  // namespace
}  // namespace voxweld
