// Decoding one compressed frame: run lengths here, JPEG and its kin by GDCM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "storage/dicom/dicom_image.h"

namespace voxweld {

// FormatError where so few stored bytes cannot hold a frame. For before its samples are allocated.
void check_ratio(const DicomImage& image, const std::string& where, std::uint64_t stored);

// Fills `out`, frame_bytes() of the image, with the samples, native byte order. What the compressed
// stream says of size and bits is compared with the header before anything is decoded.
// FormatError "<where>: ..." where they disagree or the stream is damaged.
void decode_frame(const DicomImage& image, const std::string& where,
                  std::span<const std::byte> stored, std::span<std::byte> out);

// Bytes that decoding holds beside `stored` and `out`.
std::uint64_t decoder_bytes(const DicomImage& image);

}  // namespace voxweld
