// The histogram of a volume that is read in place, kept for the next run. Kind "hist", a container
// with these sections:
//   1 bins, u64, ascending   2 their counts, u64   3 NaN samples, u64
//   4 sample type, u64 (position in enum SampleType)
#pragma once

#include <array>
#include <filesystem>

#include "storage/support/hash.h"
#include "storage/types/histogram.h"

namespace voxweld {

inline constexpr std::array<char, 4> histogram_kind = {'h', 'i', 's', 't'};
inline constexpr std::uint32_t histogram_version = 2;

struct HistogramArtifact {
  Hash128 key;
  Histogram histogram;
};

void write_histogram_artifact(const std::filesystem::path& path, const HistogramArtifact& artifact);
// DamagedArtifact when it fails its checks, StorageError when it cannot be read.
HistogramArtifact read_histogram_artifact(const std::filesystem::path& path);

}  // namespace voxweld
