// Which tiles of an output directory make up the mesh at a level of detail.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "storage/manifest/manifest.h"

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

// The tiles of coarser levels that the directory lists; none where it has no such list.
std::vector<LevelTile> listed_levels(const std::filesystem::path& output);
// The greatest height among them.
int top_of(std::span<const LevelTile> tiles);

}  // namespace voxweld
