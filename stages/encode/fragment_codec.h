// Fragments of Neuroglancer's multi-resolution meshes: Draco buffers whose positions are whole numbers of
// 32 bits, without Draco's own quantization, and without normals, which clients make.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/fragment_cut.h"

namespace voxweld {

struct FragmentMesh {
  std::vector<std::array<std::int32_t, 3>> positions;  // q, of 16 bits
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Joins equal corners; they are numbered by first use.
FragmentMesh weld_fragment(std::span<const FragmentTriangle> triangles);

// Precondition: there are triangles, none with two equal corners. InputError for more than Draco takes. The
// same mesh gives the same bytes.
std::vector<std::byte> encode_fragment(const FragmentMesh& mesh);

// FormatError, starting with `where`, for what clients would not take: anything but a whole Draco mesh with
// positions of three 32-bit integers, a value of its own for each point, all in 0 .. 65535.
FragmentMesh decode_fragment(std::span<const std::byte> bytes, const std::string& where);

}  // namespace voxweld
