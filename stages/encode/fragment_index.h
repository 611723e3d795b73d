// The manifest of an object in Neuroglancer's multi-resolution format: `<id>.index`.
//
// Little-endian: chunk_shape (3 floats), grid_origin (3 floats), number of levels, the scale of each
// (floats), vertex offsets (3 floats each: 0 here), numbers of fragments; then of each level all x, all y,
// all z and all sizes in bytes of its fragments, which lie in this order in the file `<id>`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/fragment_cut.h"
#include "storage/types/morton.h"

namespace voxweld {

// Orders the fragments of a level: x is the lowest bit.
constexpr std::uint64_t fragment_code(const FragmentCell& cell) {
  return morton_encode({cell[0], cell[1], cell[2]});
}
constexpr FragmentCell fragment_cell(std::uint64_t code) {
  const Index3 at = morton_decode(code);
  return {static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y),
          static_cast<std::uint32_t>(at.z)};
}

struct FragmentEntry {
  std::uint64_t code = 0;    // of its place
  std::uint32_t bytes = 0;   // 0: without a triangle
  std::uint8_t octants = 0;  // which of them have triangles; above level 0 alone; not in the file
  friend bool operator==(const FragmentEntry&, const FragmentEntry&) = default;
};

struct FragmentLevel {
  float scale = 0;  // the distance, in the units of chunk_shape, that its triangles stand for
  std::vector<FragmentEntry> fragments;  // by code
};

struct FragmentIndex {
  std::array<float, 3> chunk_shape{}, grid_origin{};
  std::vector<FragmentLevel> levels;  // the finest first
};

// Adds the empty fragments that clients need. They go down from a fragment to those in its octants: one
// that is not listed is not looked into, and its part is drawn from the coarser one instead. So each
// fragment has one above it, and one below for each octant where it has triangles.
void add_empty_fragments(std::vector<FragmentLevel>& levels);

std::vector<std::byte> index_bytes(const FragmentIndex& index);
// FormatError, starting with `where`, for what is no such file; octants are 0.
FragmentIndex read_index(std::span<const std::byte> bytes, const std::string& where);

}  // namespace voxweld
