// What an image file says of one of its pages.
#pragma once

#include <cstdint>
#include <string>

#include "storage/types/sample_type.h"

namespace voxweld {

struct ImagePage {
  std::int64_t width = 0, height = 0;  // pixels
  int channels = 0;                    // as decoded: a palette image has three
  SampleType type = SampleType::u8;    // of the samples as read; half floats are read as float32
  int stored_bits = 0;                 // bits of one sample in the file; 12-bit samples read as u16
  std::uint64_t decode_bytes = 0;      // held while reading any row, beyond the caller's buffer
  std::int64_t tile_width = 0, tile_height = 0;  // 0: stored by rows
  std::int64_t strip_rows = 0;  // rows decoded together; `height` when not known to be fewer

  std::string format;       // "tiff", "png" ...
  std::string compression;  // "none", "lzw", "zip" ...
  bool palette = false;     // indexed colour
  bool rescaled = false;    // samples are read stretched from `stored_bits` to the range of `type`
  bool white_is_zero = false;
  int orientation = 1;  // EXIF numbering, 1: first row on top, first column left
  // Pixels per resolution_unit ("in", "cm", "none"); 0 where the file does not say.
  double x_resolution = 0, y_resolution = 0;
  std::string resolution_unit;
  std::string description;  // TIFF ImageDescription
};

}  // namespace voxweld
