#include "tests/support/phantom_distance.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>

#include "pipeline/phantom/lattice_fields.h"

namespace voxweld {
namespace {

std::size_t number_of_sample(Index3 at, Index3 size) {
  return static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
}
// Cells by the number of their lowest sample.
std::uint64_t number_of(Index3 cell, std::int64_t size) {
  return static_cast<std::uint64_t>((cell.z * size + cell.y) * size + cell.x);
}
Vec3 place_of(std::uint64_t cell, std::int64_t size) {
  const auto number = static_cast<std::int64_t>(cell);
  const std::int64_t row = number / size, slice = row / size;
  return {static_cast<double>(number % size), static_cast<double>(row % size),
          static_cast<double>(slice)};
}

// The cells of the box that have samples on both sides.
void add_crossed(const AnalyticField& field, std::int64_t size, const Box3& box,
                 std::vector<std::uint64_t>& cells) {
  const Box3 samples{box.lo, box.hi + splat(1)};
  const Index3 across = samples.size();
  std::vector<double> values(static_cast<std::size_t>(samples.count()));
  field.fill(samples, 1, values.data());
  each_index(box, [&](Index3 cell) {
    int inside = 0;
    each_index(splat(2), [&](Index3 corner) {
      const Index3 at = cell + corner - box.lo;
      inside += values[number_of_sample(at, across)] <= 0 ? 1 : 0;
    });
    if (inside != 0 && inside != 8) cells.push_back(number_of(cell, size));
  });
}

std::vector<std::uint64_t> crossed_cells(const AnalyticField& field, std::int64_t size) {
  constexpr std::int64_t side = 64;
  std::vector<Box3> boxes;
  if (size > 1)
    each_index(pieces_of({{}, splat(size - 1)}, splat(side)), [&](Index3 at) {
      boxes.push_back({at * side, min(at * side + splat(side), splat(size - 1))});
    });
  tbb::enumerable_thread_specific<std::vector<std::uint64_t>> found;
  tbb::parallel_for(std::size_t{0}, boxes.size(),
                    [&](std::size_t i) { add_crossed(field, size, boxes[i], found.local()); });
  std::vector<std::uint64_t> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  std::ranges::sort(all);
  return all;
}

// Where the surface crosses the line from low, of length 1 along the axis; nothing where both ends
// are on one side.
std::optional<Vec3> crossing(const AnalyticField& field, Vec3 low, int axis) {
  Vec3 high = low;
  high[axis] += 1;
  const bool low_inside = field.at(low) <= 0;
  if ((field.at(high) <= 0) == low_inside) return {};
  for (int i = 0; i < 45; ++i) {
    const Vec3 middle = (low + high) * 0.5;
    ((field.at(middle) <= 0) == low_inside ? low : high) = middle;
  }
  return (low + high) * 0.5;
}

std::optional<Vec3> point_in(const AnalyticField& field, Vec3 cell, int axis, std::uint64_t hash) {
  Vec3 low = cell;
  low[(axis + 1) % 3] += uniform(mix_bits(hash, 1));
  low[(axis + 2) % 3] += uniform(mix_bits(hash, 2));
  return crossing(field, low, axis);
}

}  // namespace

std::vector<Vec3> surface_points(const AnalyticField& field, std::int64_t size, std::size_t count) {
  std::vector<std::uint64_t> cells = crossed_cells(field, size);
  // Not every k-th: that would fall in step with the lattice.
  if (cells.size() > count) {
    const double share = static_cast<double>(count) / static_cast<double>(cells.size());
    std::erase_if(cells, [&](std::uint64_t cell) { return uniform(mix_bits(0, cell)) > share; });
  }
  std::vector<std::array<std::optional<Vec3>, 3>> found(cells.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    for (int axis = 0; axis < 3; ++axis)
      found[i][static_cast<std::size_t>(axis)] =
          point_in(field, place_of(cells[i], size), axis,
                   mix_bits(static_cast<std::uint64_t>(axis) + 1, cells[i]));
  });
  std::vector<Vec3> points;
  for (const auto& of_cell : found)
    for (const auto& point : of_cell)
      if (point) points.push_back(*point);
  return points;
}

}  // namespace voxweld
