#include "pipeline/output/export.h"

#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "storage/support/error.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ReadMesh = OpenMesh::TriMesh_ArrayKernelT<>;

ReadMesh read_back(const std::filesystem::path& path) {
  ReadMesh mesh;
  OpenMesh::IO::Options options = OpenMesh::IO::Options::Binary;
  EXPECT_TRUE(OpenMesh::IO::read_mesh(mesh, path.string(), options)) << path;
  return mesh;
}

DecodedMesh decoded_torus() {
  const TileMesh torus = testing::make_torus({}, testing::small_lattice());
  return decode_draco(encode_draco(torus, {.normals = false}).bytes);
}

TEST(Export, OtherProgramsReadTheSameMesh) {
  const DecodedMesh torus = decoded_torus();
  const testing::TempDirectory directory;
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off"}) {
    export_mesh(torus, directory / name);
    const ReadMesh mesh = read_back(directory / name);
    EXPECT_EQ(mesh.n_faces(), torus.triangles.size()) << name;
    EXPECT_EQ(mesh.n_vertices(), torus.positions.size()) << name;
    for (const auto e : mesh.edges()) ASSERT_FALSE(mesh.is_boundary(e)) << name;
  }
}

TEST(Export, CoordinatesAreExactAndNormalsKept) {
  const TileMesh cube = testing::make_cube(testing::small_lattice(), {1, 2, 3}, 5, 3);
  const DecodedMesh decoded = decode_draco(encode_draco(cube, {}).bytes);
  const testing::TempDirectory directory;
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    export_mesh(decoded, directory / name);
    const ReadMesh mesh = read_back(directory / name);
    ASSERT_EQ(mesh.n_vertices(), decoded.positions.size()) << name;
    for (const auto v : mesh.vertices()) {
      const auto& p = decoded.positions[static_cast<std::size_t>(v.idx())];
      EXPECT_EQ(mesh.point(v), ReadMesh::Point(p[0], p[1], p[2])) << name;
    }
  }
}

TEST(Export, KeepsTrianglesOfComplexEdges) {
  DecodedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  const testing::TempDirectory directory;
  export_mesh(mesh, directory / "a.off");
  EXPECT_EQ(read_back(directory / "a.off").n_faces(), 3u);
}

TEST(Export, RefusesOtherFormatsAndBadPlaces) {
  const DecodedMesh torus = decoded_torus();
  const testing::TempDirectory directory;
  EXPECT_THROW(export_mesh(torus, directory / "a.xyz"), InputError);
  EXPECT_THROW(export_mesh(torus, "/proc/none/a.ply"), StorageError);
}

}  // namespace
}  // namespace voxweld
