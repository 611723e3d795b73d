#include "tests/support/phantom_distance.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <vector>

namespace voxweld {
namespace {

// Distances by size, in bins of 1/1024 of their value: bin = the upper bits of the float. Counts
// are integers, so adding them up gives the same in any order.
constexpr int dropped_bits = 13;
constexpr std::size_t bins = std::size_t{1} << (31 - dropped_bits);

std::size_t bin_of(double distance) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(distance)) >> dropped_bits;
}
double upper_end(std::size_t bin) {
  return std::bit_cast<float>(static_cast<std::uint32_t>((bin + 1) << dropped_bits) - 1);
}

// Sums of reals depend on their order, so each fixed block of items keeps its own.
struct BlockTotals {
  double sum = 0, max = 0;
};

// Statistics of per_item distances for each of `items` items: measure(item, out) fills them.
template <std::size_t per_item, class F>
DistanceStatistics statistics(std::size_t items, F&& measure) {
  constexpr std::size_t block = 1024;
  const std::size_t blocks = (items + block - 1) / block;
  std::vector<BlockTotals> totals(blocks);
  tbb::enumerable_thread_specific<std::vector<std::uint64_t>> histograms(
      [] { return std::vector<std::uint64_t>(bins); });
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    auto& histogram = histograms.local();
    std::array<double, per_item> distances;
    for (std::size_t i = b * block; i < std::min(items, (b + 1) * block); ++i) {
      measure(i, distances);
      for (const double d : distances) {
        ++histogram[bin_of(d)];
        totals[b].sum += d;
        totals[b].max = std::max(totals[b].max, d);
      }
    }
  });
  DistanceStatistics result;
  result.count = items * per_item;
  if (items == 0) return result;
  double sum = 0;
  for (const BlockTotals& t : totals) {
    sum += t.sum;
    result.max = std::max(result.max, t.max);
  }
  result.mean = sum / static_cast<double>(result.count);
  const std::uint64_t wanted = result.count - result.count / 100;
  std::uint64_t reached = 0;
  std::size_t bin = 0;
  for (; bin < bins; ++bin) {
    for (const auto& histogram : histograms) reached += histogram[bin];
    if (reached >= wanted) break;
  }
  result.p99 = std::min(upper_end(bin), result.max);
  return result;
}

constexpr std::size_t points_a_triangle = 10;

std::array<Vec3, points_a_triangle> barycentric_points() {
  std::array<Vec3, points_a_triangle> points;
  std::size_t n = 0;
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j)
      points[n++] = Vec3{i + 1.0 / 3, j + 1.0 / 3, 3 - i - j + 1.0 / 3} * 0.25;
  return points;
}

// position(i): vertex i.
template <class F>
MeshDistance measure(const AnalyticField& field, std::size_t vertices, F&& position,
                     std::span<const TriangleCorners> triangles) {
  static const auto points = barycentric_points();
  MeshDistance result;
  result.vertices = statistics<1>(vertices, [&](std::size_t i, std::array<double, 1>& out) {
    out[0] = field.surface_distance(position(i));
  });
  result.triangles = statistics<points_a_triangle>(
      triangles.size(), [&](std::size_t i, std::array<double, points_a_triangle>& out) {
        const TriangleCorners& t = triangles[i];
        assert(t[0] < vertices && t[1] < vertices && t[2] < vertices);
        const Vec3 a = position(t[0]), b = position(t[1]), c = position(t[2]);
        for (std::size_t k = 0; k < points_a_triangle; ++k)
          out[k] = field.surface_distance(a * points[k].x + b * points[k].y + c * points[k].z);
      });
  return result;
}

}  // namespace

MeshDistance measure_mesh(const AnalyticField& field, std::span<const Vec3> vertices,
                          std::span<const TriangleCorners> triangles) {
  return measure(
      field, vertices.size(), [&](std::size_t i) { return vertices[i]; }, triangles);
}

MeshDistance measure_mesh(const AnalyticField& field,
                          std::span<const std::array<float, 3>> vertices,
                          std::span<const TriangleCorners> triangles) {
  return measure(
      field, vertices.size(),
      [&](std::size_t i) {
        return Vec3{vertices[i][0], vertices[i][1], vertices[i][2]};
      },
      triangles);
}

}  // namespace voxweld
