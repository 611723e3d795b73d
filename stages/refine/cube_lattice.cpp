#include "stages/refine/cube_lattice.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

// steps: from 0 of the output's coordinates.
std::int32_t lattice_coordinate(const LatticeFrame& frame, int axis, double steps) {
  return static_cast<std::int32_t>(static_cast<std::int64_t>(steps) - frame.origin(axis));
}

// The lowest lattice coordinate of what lies at the beginning of cell u or beyond.
std::int32_t first_of_cell(const LatticeFrame& frame, int axis, std::int64_t cell) {
  return lattice_coordinate(frame, axis, std::ceil(frame.begin_of_cell(axis, cell)));
}

// The highest coordinate that a vertex may have. Of a surface that is closed at the volume's end, or
// lies in a node that is cut there, vertices lie on that end, or are snapped a little beyond it.
std::int32_t last_of_volume(const LatticeFrame& frame, int axis) {
  return static_cast<std::int32_t>(frame.end(axis) - frame.origin(axis)) + most_snap_steps;
}

}  // namespace

LatticeBox sample_box(const RefineFrame& frame) {
  LatticeBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    // Samples lie at the begins of cells 1 to size.
    box.lo[a] = lattice_coordinate(frame, axis, std::floor(frame.begin_of_cell(axis, 1)));
    box.hi[a] = first_of_cell(frame, axis, frame.size[axis]);
  }
  return box;
}

int target_cube_level(double part, std::uint64_t vertices, Index3 size) {
  constexpr double most_vertices = 1 << 18;
  const double side = 1 << refine_cube_level;
  double cubes = static_cast<double>(size.x) / side * static_cast<double>(size.y) / side *
                 static_cast<double>(size.z) / side;
  int level = refine_cube_level;
  for (double least = 0.25; level < refine_cube_level + 2 && part <= least; least /= 4, ++level) {
    cubes /= 8;
    if (static_cast<double>(vertices) > most_vertices * std::max(1.0, cubes)) break;
  }
  return level;
}

CubeLattice::CubeLattice(const RefineFrame& frame, int pass, int level) {
  const std::int64_t side = std::int64_t{1} << level;
  constexpr std::int64_t quarters[] = {0, 2, 1};
  const std::int64_t shift = quarters[pass] * side / 4;
  cubes_ = std::max<std::int64_t>(1, (std::int64_t{1} << domain_level(frame.size)) / side);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    auto& borders = borders_[a];
    borders.push_back(0);
    const std::int64_t end = frame.size[axis] + 1;  // of the volume's cells
    begins_[a] = first_of_cell(frame, axis, -shift);
    std::int64_t cell = side - shift;
    for (; cell < end; cell += side) borders.push_back(first_of_cell(frame, axis, cell));
    ends_[a] = first_of_cell(frame, axis, cell);
    borders.push_back(last_of_volume(frame, axis) + 1);
    const double steps = static_cast<double>(side) * frame.spacing[axis] / frame.lattice.step;
    sides_[a] = std::max(1, static_cast<std::int32_t>(steps));
  }
}

LatticeBox CubeLattice::bounds() const {
  LatticeBox all;
  for (std::size_t a = 0; a < 3; ++a) {
    all.lo[a] = borders_[a].front();
    all.hi[a] = borders_[a].back() - 1;
  }
  return all;
}

Index3 CubeLattice::cube_of(const LatticePoint& point) const {
  Index3 cube;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<std::int32_t>& borders = borders_[a];
    const auto last = static_cast<std::int64_t>(borders.size()) - 2;
    // Borders are nearly even.
    std::int64_t at = std::clamp<std::int64_t>((point[a] - borders[1]) / sides_[a] + 1, 0, last);
    while (at > 0 && point[a] < borders[static_cast<std::size_t>(at)]) --at;
    while (at < last && point[a] >= borders[static_cast<std::size_t>(at) + 1]) ++at;
    cube[static_cast<int>(a)] = at;
  }
  return cube;
}

LatticeBox CubeLattice::box(Index3 cube) const {
  LatticeBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(cube[static_cast<int>(a)]);
    box.lo[a] = borders_[a][at];
    box.hi[a] = borders_[a][at + 1] - 1;
  }
  return box;
}

LatticeBox CubeLattice::whole(Index3 cube) const {
  LatticeBox whole = box(cube);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(cube[static_cast<int>(a)]);
    if (at == 0) whole.lo[a] = std::min(whole.lo[a], begins_[a]);
    if (at + 2 == borders_[a].size()) whole.hi[a] = std::max(whole.hi[a], ends_[a] - 1);
  }
  return whole;
}

std::uint64_t CubeLattice::code(Index3 cube) const {
  const std::int64_t last = cubes_ - 1;
  return morton_encode({std::min(cube.x, last), std::min(cube.y, last), std::min(cube.z, last)});
}

}  // namespace voxweld
