// From the rows of a TIFF, as they are stored, to samples of our types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "storage/types/sample_type.h"

namespace voxweld {

// What the tags BitsPerSample and SampleFormat say.
struct TiffSampleTags {
  int bits = 1;    // of one sample
  int format = 1;  // 1: unsigned, 2: signed, 3: floating point, 4: not said; others: complex
};

// The smallest type that holds such samples; nothing where there is none.
std::optional<SampleType> tiff_sample_type(const TiffSampleTags& tags);

// How samples lie in a row, and what they become.
struct TiffCoding {
  TiffSampleTags tags;
  SampleType type = SampleType::u8;  // as tiff_sample_type() gives it
  bool white_is_zero = false;        // unsigned ones are turned so that brighter is larger
};

// Some samples of one row: `count` of them, each `step` behind the one before.
struct TiffRun {
  std::size_t first = 0, step = 1, count = 0;  // in samples
};

// Puts the run into `out`, each `out_step` samples behind the one before. Samples of 8, 16, 32 and
// 64 bits and floats of 24 are expected in native byte order, those of other depths as a stream of
// bits, the most significant one first. (Of integers of 24 bits the format does not say; those who
// write them take them for such a stream.)
void convert_tiff_run(const TiffCoding& coding, const std::byte* row, const TiffRun& run,
                      std::byte* out, std::size_t out_step);

}  // namespace voxweld
