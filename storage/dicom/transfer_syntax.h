// How a DICOM file stores its elements and samples.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace voxweld {

enum class FrameCoding : std::uint8_t {
  native,  // the samples' bytes
  run_lengths,
  jpeg,  // 8, 12 and 16 bits, lossy and lossless
  jpeg_ls,
  jpeg_2000,
  unknown,  // not read
};

struct TransferSyntax {
  std::string uid;
  std::string name;
  std::endian order = std::endian::little;
  bool explicit_vr = true;
  bool deflated = false;  // everything behind the file's meta information
  FrameCoding coding = FrameCoding::unknown;
};

// An unknown one is taken for what all compressed ones are, explicit and little endian.
TransferSyntax transfer_syntax(std::string_view uid);
inline constexpr std::string_view implicit_little_uid = "1.2.840.10008.1.2";
inline constexpr std::string_view explicit_little_uid = "1.2.840.10008.1.2.1";

}  // namespace voxweld
