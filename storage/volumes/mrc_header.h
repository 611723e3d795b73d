// The first 1024 bytes of an MRC or CCP4 file as plain values.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace voxweld {

inline constexpr std::size_t mrc_header_bytes = 1024;

// Arrays of three are of columns, rows, sections where the comment says "file", else of X, Y, Z.
struct MrcHeader {
  std::endian byte_order = std::endian::little;
  bool stamped = true;                    // byte_order is what the machine stamp says
  std::array<std::int32_t, 3> size{};     // file
  std::int32_t mode = 0;                  // of the samples
  std::array<std::int32_t, 3> start{};    // file: index of the first column, row, section
  std::array<std::int32_t, 3> grid{};     // intervals in the cell
  std::array<float, 3> cell{}, angles{};  // sides in angstrom; degrees
  std::array<std::int32_t, 3> axes{};     // file: 1 for X, 2 for Y, 3 for Z
  float lowest = 0, highest = 0;          // sample; lowest > highest: not known
  std::int32_t space_group = 0;
  std::int32_t extended_bytes = 0;  // of a header between this one and the samples
  std::int32_t version = 0;         // of the format: 20140 and so on; 0 in older files
  bool of_imod = false;             // written by IMOD, with imod_flags
  std::int32_t imod_flags = 0;
  std::array<float, 3> origin{};  // of the samples, in angstrom
  bool has_map = false;           // the letters MAP
};

// Empty unless sizes, mode, axes and the length of the extended header make sense in one byte
// order: that of the machine stamp first.
std::optional<MrcHeader> parse_mrc_header(std::span<const std::byte> bytes);

}  // namespace voxweld
