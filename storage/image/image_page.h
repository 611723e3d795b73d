// What an image file says of one of its pages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/sample_type.h"

namespace voxweld {

struct ImagePage {
  std::int64_t width = 0, height = 0;      // pixels
  int channels = 0;                        // samples a pixel, as decoded
  std::vector<std::string> channel_names;  // "R", "G" ...; may be fewer than there are
  SampleType type = SampleType::u8;        // of the samples as read; half floats become float32
  int stored_bits = 0;             // bits of one sample in the file; 12-bit samples read as u16
  std::uint64_t decode_bytes = 0;  // held while reading any row, beyond the caller's buffer
  std::int64_t tile_width = 0, tile_height = 0;  // 0: stored by rows
  std::int64_t strip_rows = 0;  // rows decoded together; `height` when not known to be fewer

  std::string format;       // "tiff", "png" ...
  std::string compression;  // "none", "lzw", "zip" ...
  bool palette = false;     // indexed colour; of a TIFF the indices are read, of others the colours
  bool rescaled = false;    // samples are read stretched from `stored_bits` to the range of `type`
  bool white_is_zero = false;
  int orientation = 1;  // EXIF numbering, 1: first row on top, first column left
  // Pixels per resolution_unit ("in", "cm", "none"); 0 where the file does not say.
  double x_resolution = 0, y_resolution = 0;
  std::string resolution_unit;
  std::string description;  // TIFF ImageDescription

  int levels = 1;  // resolutions of this page: 1 and those in SubIFDs
  // Where the samples begin in the file, if they lie there as they are read, but for their byte
  // order: of one channel, row behind row.
  std::optional<std::uint64_t> raw_offset;
  bool big_endian = false;  // their byte order
};

// Rows [y0, y1) of a page: of one channel, or of all of them, interleaved.
struct ImageRows {
  int page = 0;
  std::int64_t y0 = 0, y1 = 0;
  std::optional<int> channel{};
};

}  // namespace voxweld
