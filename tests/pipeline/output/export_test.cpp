#include "pipeline/output/export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>
#include <cstring>
#include <set>

#include "pipeline/output/wide_mesh.h"
#include "storage/support/error.h"
#include "tests/pipeline/output/output_directory.h"
#include "tests/support/error_text.h"
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

void export_mesh(const DecodedMesh& mesh, const std::filesystem::path& path) {
  write_exported(path, exported_mesh(mesh, path));
}

void export_wide_mesh(const WideMesh& mesh, const std::filesystem::path& path) {
  write_exported(path, exported_wide_mesh(mesh, path));
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

// What a .ply holds, read by hand: OpenMesh knows no doubles and no labels.
struct PlyFile {
  std::string header;
  std::vector<std::byte> body;
  template <class T>
  T at(std::size_t offset) const {
    T value;
    std::memcpy(&value, body.data() + offset, sizeof value);
    return value;
  }
};

PlyFile ply_file(const std::filesystem::path& path) {
  const auto bytes = read_whole_file(path);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto end = text.find("end_header\n") + 11;
  return {text.substr(0, end), {bytes.begin() + static_cast<std::ptrdiff_t>(end), bytes.end()}};
}

double volume_of(const WideMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6;
  return sum;
}

class ExportOfDirectory : public ::testing::Test {
 protected:
  ExportOfDirectory() {
    output_.tiles = {testing::make_cube(testing::small_lattice(), {1, 2, 3}, 5, 3),
                     testing::make_cube(testing::small_lattice(), {20, 2, 3}, 5, 3)};
    output_.merged = false;
  }
  std::filesystem::path write() {
    output_.write(directory_.path());
    return directory_.path();
  }
  testing::TempDirectory directory_;
  testing::OutputDirectory output_;
};

TEST_F(ExportOfDirectory, WeldedMeshesHaveOneVertexAPosition) {
  const auto output = write();
  const WideMesh plain = load_wide_mesh(output, {}),
                 welded = load_wide_mesh(output, {.weld = true});
  const auto count = [](const WideMesh& mesh) {
    std::set<std::array<double, 3>> places;
    for (const Vec3& p : mesh.positions) places.insert({p.x, p.y, p.z});
    return places.size();
  };
  EXPECT_GT(plain.positions.size(), count(plain));  // creases
  EXPECT_EQ(welded.positions.size(), count(plain));
  EXPECT_EQ(welded.triangles.size(), plain.triangles.size());
  EXPECT_TRUE(welded.normals.empty());
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off"}) {
    export_wide_mesh(welded, directory_ / name);
    const ReadMesh mesh = read_back(directory_ / name);
    EXPECT_EQ(mesh.n_vertices(), welded.positions.size()) << name;
    EXPECT_EQ(mesh.n_faces(), welded.triangles.size()) << name;
    for (const auto e : mesh.edges()) ASSERT_FALSE(mesh.is_boundary(e)) << name;
  }
}

// Origin, direction and, by the coordinates of the files, first; a mirrored world turns triangles.
TEST_F(ExportOfDirectory, WorldCoordinatesAreDoublesAndStillFaceOutward) {
  output_.restate = [](Manifest& manifest) {
    manifest.frame.origin = {1e7 + 0.125, -2e7, 3};
    manifest.frame.direction = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
    manifest.frame.space = "LPS";
  };
  const auto output = write();
  const WideMesh own = load_wide_mesh(output, {}), world = load_wide_mesh(output, {.world = true});
  ASSERT_EQ(world.positions.size(), own.positions.size());
  for (std::size_t i = 0; i < own.positions.size(); ++i) {
    const Vec3 p = own.positions[i];
    EXPECT_EQ(world.positions[i], (Vec3{1e7 + 0.125 + p.y, -2e7 + p.x, 3 + p.z}));
    EXPECT_EQ(world.normals[i][0], own.normals[i][1]);
  }
  WideMesh near = world;
  for (Vec3& p : near.positions) p = p - Vec3{1e7, -2e7, 0};
  EXPECT_GT(volume_of(own), 0);
  EXPECT_NEAR(volume_of(near), volume_of(own), 1e-3);
  export_wide_mesh(world, directory_ / "a.ply");
  const PlyFile ply = ply_file(directory_ / "a.ply");
  EXPECT_THAT(ply.header, ::testing::HasSubstr("comment world coordinates, LPS, in mm\n"));
  EXPECT_THAT(ply.header, ::testing::HasSubstr("property double x\n"));
  EXPECT_EQ(ply.at<double>(0), world.positions[0].x);
  // A file takes the frame of the directory that it lies in.
  EXPECT_EQ(load_wide_mesh(output / "tiles/0.drc", {.world = true}).positions[0].z,
            load_wide_mesh(output / "tiles/0.drc", {}).positions[0].z + 3);
}

TEST_F(ExportOfDirectory, WorldNeedsAManifest) {
  const auto output = write();
  const testing::TempDirectory elsewhere;
  std::filesystem::copy_file(output / "tiles/0.drc", elsewhere / "mesh.drc");
  EXPECT_THAT(testing::error_text<InputError>(
                  [&] { load_wide_mesh(elsewhere / "mesh.drc", {.world = true}); }),
              ::testing::HasSubstr("--world needs the manifest.json of the output directory"));
}

TEST_F(ExportOfDirectory, LabelsAreAPropertyOfFaces) {
  output_.labels = {3, 70000};
  const WideMesh mesh = load_wide_mesh(write(), {.weld = true});
  ASSERT_EQ(mesh.labels.size(), mesh.triangles.size());
  EXPECT_EQ(mesh.labels.front(), 3U);
  EXPECT_EQ(mesh.labels.back(), 70000U);
  export_wide_mesh(mesh, directory_ / "a.ply");
  const PlyFile ply = ply_file(directory_ / "a.ply");
  EXPECT_THAT(ply.header, ::testing::HasSubstr("vertex_indices\nproperty int label\nend_header"));
  const std::size_t faces = 12 * mesh.positions.size();
  EXPECT_EQ(ply.body.size(), faces + 17 * mesh.triangles.size());
  EXPECT_EQ(ply.at<std::int32_t>(faces + 13), 3);
  EXPECT_EQ(ply.at<std::int32_t>(ply.body.size() - 4), 70000);
  EXPECT_EQ(read_back(directory_ / "a.ply").n_faces(), mesh.triangles.size());
}

TEST(Export, LabelsOnBothSidesAndLargeOnes) {
  WideMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.labels = {std::uint64_t{1} << 40};
  mesh.labels_outside = {exterior};
  const testing::TempDirectory directory;
  export_wide_mesh(mesh, directory / "a.ply");
  const PlyFile ply = ply_file(directory / "a.ply");
  EXPECT_THAT(ply.header,
              ::testing::HasSubstr("property double label\nproperty double label_outside\n"));
  EXPECT_EQ(ply.at<double>(36 + 13), std::ldexp(1.0, 40));
  EXPECT_EQ(ply.at<double>(36 + 21), -1.0);
}

}  // namespace
}  // namespace voxweld
