// How noisy a volume's samples are around one surface, kept so that they are looked at once. Kind
// "nois", a container with these sections:
//   1 the standard deviation, f64, of the samples as stored
//   2 in how many places a side of the volume they were looked at, u64
#pragma once

#include <array>
#include <filesystem>

#include "storage/support/hash.h"

namespace voxweld {

inline constexpr std::array<char, 4> noise_kind = {'n', 'o', 'i', 's'};
inline constexpr std::uint32_t noise_version = 1;

struct NoiseArtifact {
  Hash128 key;
  double level = 0;
  std::uint64_t places = 0;
};

void write_noise_artifact(const std::filesystem::path& path, const NoiseArtifact& artifact);
// DamagedArtifact when it fails its checks, StorageError when it cannot be read.
NoiseArtifact read_noise_artifact(const std::filesystem::path& path);

}  // namespace voxweld
