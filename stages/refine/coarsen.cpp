#include "stages/refine/coarsen.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "stages/refine/box_refiner.h"
#include "stages/refine/mesh_distance.h"
#include "stages/refine/retile.h"
#include "storage/types/index_table.h"

namespace voxweld {
namespace {

std::uint64_t lot_of(const LatticePoint& p) {
  std::uint64_t lot = 0;
  for (const std::int32_t coordinate : p)
    lot = mix_bits(lot ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(coordinate)));
  return lot;
}

struct Drawn {
  double distance = 0;  // from its triangle
  std::uint64_t lot = 0;
  SurfaceSample sample;
};

// The one that is farthest, and some that are drawn by lot: which ones depends on the points alone.
void choose(std::vector<Drawn>& samples) {
  if (samples.size() <= level_samples) return;
  const auto key = [](const Drawn& d) { return std::tuple(d.lot, d.sample.point); };
  const auto farther = [&](const Drawn& a, const Drawn& b) {
    return a.distance != b.distance ? a.distance > b.distance : key(a) < key(b);
  };
  std::iter_swap(samples.begin(), std::ranges::min_element(samples, farther));
  std::sort(samples.begin() + 1, samples.end(),
            [&](const Drawn& a, const Drawn& b) { return key(a) < key(b); });
  samples.resize(level_samples);
}

// Counts how far all samples lie off, and leaves a few of each triangle.
void count_and_thin(RefineMesh& mesh, RefineCounts& counts) {
  counts.worst = 0;
  counts.distances = {};
  std::vector<SurfaceSample> left;
  std::vector<Drawn> drawn;
  for (auto s = mesh.samples.begin(); s != mesh.samples.end();) {
    const std::uint32_t triangle = s->triangle;
    const LatticeTriangle shape = mesh.shape(triangle);
    drawn.clear();
    for (; s != mesh.samples.end() && s->triangle == triangle; ++s) {
      drawn.push_back({std::sqrt(squared_distance(s->point, shape)), lot_of(s->point), *s});
      counts.add_distance(drawn.back().distance);
    }
    choose(drawn);
    for (const Drawn& one : drawn) left.push_back(one.sample);
  }
  mesh.samples = std::move(left);
}

RefineMesh at_home(const RefineMesh& mesh, CellKey cell, const RefineFrame& frame) {
  const CubeLattice blocks = tile_blocks(frame);
  MeshGather own;
  own.add(mesh, [&](std::size_t t) { return belongs_to(mesh, t, blocks, cell); });
  return own.take();
}

}  // namespace

double level_tolerance(double finest, int height) {
  return finest * std::pow(level_tolerance_factor, height);
}

std::int32_t level_grain(double tolerance) {
  constexpr double parts = 12, most = 1 << 20;
  if (!(tolerance < parts * most)) return 1;
  return static_cast<std::int32_t>(
      std::bit_floor(static_cast<std::uint32_t>(std::max(tolerance / parts, 1.0))));
}

RefineMesh coarsen(const RefineMesh& mesh, const RefineFrame& frame, const CoarseNode& node,
                   const RefineParameters& finest, RefineCounts& counts) {
  RefineParameters parameters = finest;
  parameters.mode = RefineMode::collapse;
  parameters.tolerance = level_tolerance(finest.tolerance, node.height);
  parameters.reach = std::ldexp(finest.reach, node.height);  // as long as edges get
  parameters.places.reset();
  parameters.normals = {level_normal_cosine, false};
  parameters.grain = level_grain(parameters.tolerance);
  if (!node.all) parameters.within = CubeLattice(frame, 0, node.cell.level).box(node.cell.at);
  // Cubes that grow with the edges in them.
  const int level = frame.level + node.height;
  RefineCounts first, second;
  RefineMesh refined = refine_range(mesh, CubeLattice(frame, 0, level), {}, parameters, first);
  refined = refine_range(refined, CubeLattice(frame, 1, level), {}, parameters, second);
  RefineMesh own;
  if (!node.all) own = at_home(refined, node.cell, frame);
  RefineMesh& result = node.all ? refined : own;
  counts = first;
  counts.add(second);
  counts.pairs_before = first.pairs_before;
  counts.pairs_left = second.pairs_left;
  count_and_thin(result, counts);
  counts.worst = largest_distance(result, MeasuredPoints::all, MeshDistance(mesh), counts.worst);
  counts.worst =
      largest_distance(mesh, MeasuredPoints::long_edges, MeshDistance(refined), counts.worst);
  return std::move(result);
}

std::uint64_t coarsen_bytes(const MeshSize& all) {
  MeshSize own = all;
  own.samples += own.vertices;  // of which each that goes or moves leaves one
  // The second pass holds what the first has made.
  return refine_bytes(all, own) + MeshDistance::bytes(all.triangles) +
         2 * mesh_bytes(own.vertices, own.triangles, own.samples, own.sided);
}

}  // namespace voxweld
