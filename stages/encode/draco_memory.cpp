// What encoding and decoding take, from test_encode_memory (Draco 1.5.5, speeds 0 to 10, meshes of
// 0.1 to 1.0 M triangles, every allocation counted). The most seen, bytes a triangle at half a
// vertex a triangle: encoding 124 without normals; with them 168 where a few edges are seams and
// 294 where each corner has a normal of its own. Decoding 85, 120 and 258.
#include "stages/encode/draco_codec.h"

namespace voxweld {
namespace {

// Entropy coding tables, whose size is that of the largest residual.
constexpr std::uint64_t fixed = std::uint64_t{16} << 20;

}  // namespace

std::uint64_t encode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles, bool normals) {
  return fixed + (normals ? 100 * vertices + 260 * triangles : 50 * vertices + 110 * triangles);
}

std::uint64_t decode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles, bool normals) {
  return fixed + (normals ? 100 * vertices + 220 * triangles : 40 * vertices + 70 * triangles);
}

}  // namespace voxweld
