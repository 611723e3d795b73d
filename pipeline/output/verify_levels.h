// Coarser levels of detail, each checked as the mesh itself is: its tiles weld without a crack.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/output/seam_check.h"
#include "pipeline/output/verify_tiles.h"

namespace voxweld {

// A tile of a coarser level: its cube and its height.
struct LevelTile {
  CellKey cell;
  int lod = 1;
};

// Of which tiles the mesh is made where some levels are shown and no coarser ones.
class LevelCut {
 public:
  // tiles: those of levels.jsonl. top: the greatest height that is shown.
  LevelCut(std::span<const LevelTile> tiles, int top);

  // Of either list.
  bool takes(const TileRecord& record) const;

 private:
  struct Shown {
    std::uint64_t begin = 0, end = 0;  // Morton codes of finest cells
    int lod = 0;
  };
  std::vector<Shown> shown_;  // ascending, apart
};

struct LevelVerifier {
  const std::filesystem::path& directory;
  const TileReader& tiles;
  const PointFrame& frame;
  SeamRules rules;
  int threads = 1;
  std::function<void()> between;       // called before each tile
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
