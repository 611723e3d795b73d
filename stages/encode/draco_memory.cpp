// What encoding and decoding take, as test_encode_memory measures it.
#include "stages/encode/draco_codec.h"

namespace voxweld {
namespace {
constexpr std::uint64_t fixed = std::uint64_t{1} << 20;
}

std::uint64_t encode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles) {
  return fixed + 200 * vertices + 200 * triangles;
}

std::uint64_t decode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles) {
  return fixed + 200 * vertices + 200 * triangles;
}

}  // namespace voxweld
