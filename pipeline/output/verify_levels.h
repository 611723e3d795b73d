// Coarser levels of detail, each checked as the mesh itself is: its tiles weld without a crack.
#pragma once

#include <cstdint>
#include <functional>

#include "pipeline/output/seam_check.h"
#include "pipeline/output/verify_tiles.h"

namespace voxweld {

struct LevelVerifier {
  const std::filesystem::path& directory;
  const TileReader& tiles;
  const PointFrame& frame;
  SeamRules rules;
  bool each_label = false;  // labels.mode = "each"
  int threads = 1;
  std::function<void()> between;  // called before each tile
  std::function<void(Problem)> report;
};

struct LevelTotals {
  std::uint64_t levels = 0;  // beside the mesh itself
  std::uint64_t tiles = 0, files = 0, bytes = 0;
};

// Of an output that has levels.jsonl. Checks each level's files and tiles, and that the whole is as
// closed as the mesh. Errors as verify_output.
LevelTotals verify_levels(const LevelVerifier& verifier);

}  // namespace voxweld
