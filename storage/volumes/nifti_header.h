// The binary header of NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes), either byte order, as one plain
// struct.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace voxweld {

inline constexpr std::size_t nifti1_bytes = 348;
inline constexpr std::size_t nifti2_bytes = 540;

struct NiftiHeader {
  int version = 1;
  bool single_file = true;  // "n+1": samples follow the header; "ni1": they are in the .img file
  std::endian byte_order = std::endian::little;
  std::array<std::int64_t, 8> dim{};  // dim[0]: number of dimensions
  std::int32_t datatype = 0, bitpix = 0;
  std::array<double, 8> pixdim{};  // pixdim[0]: the sign of the third axis in the qform
  double vox_offset = 0;
  double slope = 0, inter = 0;
  std::int32_t qform_code = 0, sform_code = 0;
  std::array<double, 3> quatern{}, qoffset{};
  std::array<std::array<double, 4>, 3> srow{};  // world x, y, z as rows
  std::int32_t units = 0;
};

// Empty when the bytes are no NIfTI header: magic and length do not match.
std::optional<NiftiHeader> parse_nifti_header(std::span<const std::byte> bytes);

// True for a header of the format's predecessor, Analyze 7.5: the same length, no magic.
bool looks_analyze(std::span<const std::byte> bytes);

}  // namespace voxweld
