#include "stages/merge/tile_planner.h"

#include <utility>

namespace voxweld {

TilePlanner::TilePlanner(int domain_level, std::uint64_t tile_vertices,
                         std::function<void(const PlannedTile&)> emit)
    : root_{domain_level, {}}, limit_(tile_vertices), emit_(std::move(emit)) {}

void TilePlanner::push(const CubeCount& cube) {
  if (cube.vertices == 0 && cube.polygons == 0) return;
  const PlannedTile part{cube.code, cube.level, 0, cube.vertices, cube.polygons};
  while (!open_.empty() && !open_.back().key.cells().contains(part.key().cells())) close_last();
  if (part.key() == root_) {
    emit_(part);
    return;
  }
  if (open_.empty()) open_.push_back({root_, false, 0, 0, {}});
  while (open_.back().key.level > static_cast<int>(cube.level) + 1) {
    CellKey child = part.key();
    while (child.level + 1 < open_.back().key.level) child = child.parent();
    open_.push_back({child, false, 0, 0, {}});
  }
  add(part);
}

void TilePlanner::add(const PlannedTile& part) {
  OpenNode& node = open_.back();
  node.vertices += part.vertices;
  node.polygons += part.polygons;
  if (node.vertices > limit_ && !node.too_large) mark_too_large();
  if (node.too_large)
    emit_(part);
  else
    node.parts.push_back(part);
}

// A node too large makes all its ancestors too large: what they kept back are tiles, the oldest
// first.
void TilePlanner::mark_too_large() {
  for (OpenNode& node : open_) {
    if (node.too_large) continue;
    node.too_large = true;
    for (const PlannedTile& part : node.parts) emit_(part);
    node.parts.clear();
  }
}

void TilePlanner::close_last() {
  const OpenNode node = std::move(open_.back());
  open_.pop_back();
  if (node.too_large || node.polygons + node.vertices == 0) return;
  const PlannedTile whole{node.key.code(), static_cast<std::uint32_t>(node.key.level), 0,
                          node.vertices, node.polygons};
  if (open_.empty())
    emit_(whole);
  else
    add(whole);
}

void TilePlanner::finish() {
  while (!open_.empty()) close_last();
}

}  // namespace voxweld
