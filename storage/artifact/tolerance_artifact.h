// The tolerance that a pass of refine goes by, where it is chosen. Kind "tolr", a container with these
// sections:
//   1 ChosenTolerance (one)
//   2 hash of the contents of all that it was chosen by, 16 bytes
#pragma once

#include <array>
#include <filesystem>

#include "storage/support/hash.h"

namespace voxweld {

inline constexpr std::array<char, 4> tolerance_kind = {'t', 'o', 'l', 'r'};
inline constexpr std::uint32_t tolerance_version = 1;

struct ChosenTolerance {
  double tolerance = 0;       // lattice steps
  std::uint64_t before = 0;   // triangles, of the mesh that was stitched
  std::uint64_t target = 0;   // how many are to be left
  std::uint64_t left = 0;     // about how many there will be
  std::uint64_t reached = 1;  // 0: no tolerance leaves so few
  friend bool operator==(const ChosenTolerance&, const ChosenTolerance&) = default;
};

struct ToleranceArtifact {
  Hash128 key;
  ChosenTolerance chosen;
  Hash128 sources;
};

void write_tolerance_artifact(const std::filesystem::path& path, const ToleranceArtifact& artifact);
// DamagedArtifact when it fails its checks, StorageError when it cannot be read.
ToleranceArtifact read_tolerance_artifact(const std::filesystem::path& path);

}  // namespace voxweld
