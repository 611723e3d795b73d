#include "pipeline/output/intersection_check.h"

#include <algorithm>

#include "stages/exact/intersections.h"

namespace voxweld {
namespace {

bool leaves(const LatticeTriangle& triangle, const Box3& cube, const PointFrame& frame) {
  return std::ranges::any_of(triangle,
                             [&](const LatticePoint& q) { return !cube.contains(frame.cell(q)); });
}

}  // namespace

IntersectionCount& IntersectionCount::operator+=(const IntersectionCount& other) {
  pairs += other.pairs;
  degenerate += other.degenerate;
  const std::size_t room = most_places - first.size();
  first.insert(
      first.end(), other.first.begin(),
      other.first.begin() + static_cast<std::ptrdiff_t>(std::min(room, other.first.size())));
  return *this;
}

TileIntersections intersections_within(const LatticeMesh& mesh, const CellKey& tile,
                                       const PointFrame& frame) {
  TileIntersections found;
  const TriangleList list{mesh.positions, mesh.triangles};
  if (list.size() == 0) return found;
  found.box = LatticeBox::around(mesh.positions);
  const Box3 cube = tile.cells();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const LatticeTriangle triangle = list[i];
    if (has_no_area(triangle))
      ++found.count.degenerate;
    else if (leaves(triangle, cube, frame))
      found.leaving.push_back(triangle);
  }
  each_intersection(list, [&](std::uint32_t i, std::uint32_t) {
    found.count.note(frame.position(list[i].front()));
  });
  return found;
}

void IntersectionCheck::add(TileIntersections&& tile) {
  within_ += tile.count;
  leaving_from_.insert(leaving_from_.end(), tile.leaving.size(),
                       static_cast<std::uint32_t>(boxes_.size()));
  leaving_.insert(leaving_.end(), tile.leaving.begin(), tile.leaving.end());
  boxes_.push_back(tile.box);
}

void IntersectionCheck::close() {
  std::vector<LatticeBox> boxes;
  boxes.reserve(leaving_.size());
  for (const LatticeTriangle& triangle : leaving_) boxes.push_back(LatticeBox::around(triangle));
  tree_ = std::make_unique<BoxTree>(boxes);
}

bool IntersectionCheck::needs(std::size_t tile) const {
  bool any = false;
  tree_->each_meeting(boxes_[tile],
                      [&](std::uint32_t other) { any |= leaving_from_[other] != tile; });
  return any;
}

IntersectionCount IntersectionCheck::between(std::size_t tile, const LatticeMesh& mesh,
                                             const CellKey& cube, const PointFrame& frame) const {
  IntersectionCount found;
  const TriangleList list{mesh.positions, mesh.triangles};
  const Box3 cells = cube.cells();
  each_intersection(list, {leaving_, *tree_}, [&](std::uint32_t own, std::uint32_t other) {
    const std::uint32_t from = leaving_from_[other];
    // Where both leave their cubes, it is found from either side: it counts from the later one.
    if (from == tile || (from > tile && leaves(list[own], cells, frame))) return;
    found.note(frame.position(list[own].front()));
  });
  return found;
}

}  // namespace voxweld
