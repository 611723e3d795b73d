// Simplifies a mesh with meshoptimizer, to compare with.
// Usage: meshopt_simplify INPUT OUTPUT.ply SHARE
// SHARE: of the triangles to keep. There is no bound on the error, so the share alone ends it.
// Prints the seconds that it took, from triangles in memory to triangles in memory.
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"

namespace {

struct FloatMesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<unsigned> corners;
};

FloatMesh read(const char* path) {
  const voxweld::TriangleMesh mesh = voxweld::read_mesh_file(path).mesh;
  FloatMesh read;
  for (const voxweld::Vec3& v : mesh.vertices)
    read.vertices.push_back(
        {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
  for (const auto& t : mesh.triangles) read.corners.insert(read.corners.end(), t.begin(), t.end());
  return read;
}

// Without the vertices that are no longer used.
void write(const char* path, FloatMesh mesh) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<unsigned> becomes(mesh.vertices.size());
  const std::size_t used = meshopt_optimizeVertexFetchRemap(
      becomes.data(), mesh.corners.data(), mesh.corners.size(), mesh.vertices.size());
  std::vector<std::array<float, 3>> vertices(used);
  for (std::size_t i = 0; i < becomes.size(); ++i)
    if (becomes[i] != ~0U) vertices[becomes[i]] = mesh.vertices[i];
  std::ofstream file(path, std::ios::binary);
  file << fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      used, mesh.corners.size() / 3);
  file.write(reinterpret_cast<const char*>(vertices.data()),
             static_cast<std::streamsize>(vertices.size() * sizeof(vertices[0])));
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    const std::array<unsigned, 3> t = {becomes[mesh.corners[i]], becomes[mesh.corners[i + 1]],
                                       becomes[mesh.corners[i + 2]]};
    file.put(3);
    file.write(reinterpret_cast<const char*>(t.data()), sizeof(t));
  }
  if (!file.flush()) throw voxweld::StorageError(fmt::format("{}: cannot write", path));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) {
    fmt::print(stderr, "usage: meshopt_simplify INPUT OUTPUT.ply SHARE\n");
    return 2;
  }
  FloatMesh mesh = read(argv[1]);
  const auto wanted =
      static_cast<std::size_t>(static_cast<double>(mesh.corners.size()) / 3 * std::atof(argv[3]));
  const auto start = std::chrono::steady_clock::now();
  const std::size_t left =
      meshopt_simplify(mesh.corners.data(), mesh.corners.data(), mesh.corners.size(),
                       mesh.vertices[0].data(), mesh.vertices.size(), sizeof(mesh.vertices[0]),
                       3 * wanted, std::numeric_limits<float>::max());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  mesh.corners.resize(left);
  write(argv[2], std::move(mesh));
  fmt::print("{}\n", seconds.count());
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
