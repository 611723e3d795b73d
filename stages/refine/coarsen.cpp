#include "stages/refine/coarsen.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_set>

#include "stages/refine/box_refiner.h"
#include "stages/refine/mesh_distance.h"
#include "stages/refine/retile.h"
#include "stages/refine/sample_choice.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

// The last nodes are few, and have one large cube after the other: two of them keep two threads busy.
constexpr std::size_t triangles_at_once = 2 * most_part_triangles;

// Whether cubes have so many triangles that what is done in one does not stay in the processor's cache.
// Where they have few, a triangle is better as long as a large cube lets it be.
bool are_dense(const RefineMesh& mesh, const CubeLattice& cubes) {
  constexpr std::size_t many = 8192;
  std::unordered_set<std::uint64_t> populated;
  NearbyCubes nearby(cubes);
  for (const auto& corners : mesh.triangles)
    if (nearby.moves_to(mesh.positions[corners[0]]) || populated.empty())
      populated.insert(morton_encode(nearby.cube()));
  return mesh.triangles.size() > many * populated.size();
}

RefineMesh at_home(const RefineMesh& mesh, CellKey cell, const RefineFrame& frame) {
  const CubeLattice blocks = tile_blocks(frame);
  MeshGather own;
  own.add(mesh, [&](std::size_t t) { return belongs_to(mesh, t, blocks, cell); });
  return own.take();
}

}  // namespace

double level_tolerance(double finest, int doublings) {
  return std::ldexp(finest, doublings);
}

std::int32_t level_grain(double tolerance) {
  constexpr double parts = 12, most = 1 << 20;
  if (!(tolerance < parts * most)) return 1;
  return static_cast<std::int32_t>(
      std::bit_floor(static_cast<std::uint32_t>(std::max(tolerance / parts, 1.0))));
}

RefineMesh coarsen(RefineMesh mesh, const RefineFrame& frame, const CoarseNode& node,
                   const RefineParameters& finest, RefineCounts& counts) {
  RefineParameters parameters = finest;
  parameters.mode = RefineMode::collapse;
  parameters.tolerance = level_tolerance(finest.tolerance, node.doublings);
  parameters.reach =
      finest.reach * std::sqrt(std::ldexp(1.0, node.doublings));  // as long as edges get
  parameters.normals = {level_normal_cosine, level_own_cosine};
  parameters.grain = level_grain(parameters.tolerance);
  // The mesh was settled already. With it again levels of porous stone took 8 % longer, had half a percent
  // fewer triangles and were up to 3 % further off.
  parameters.settles = false;
  parameters.counts_distances = false;  // but in the end
  parameters.at_once = triangles_at_once;
  if (!node.all) parameters.within = CubeLattice(frame, 0, node.cell.level).box(node.cell.at);
  // Cubes that grow with the edges in them. Borders of both passes never lie together.
  const int level = frame.level + (node.doublings + 1) / 2;
  const int first_level = are_dense(mesh, CubeLattice(frame, 0, level)) ? level - 1 : level;
  RefineCounts first, second;
  RefineMesh refined =
      refine_range(mesh, CubeLattice(frame, 1, first_level), {}, parameters, first);
  refined = refine_range(refined, CubeLattice(frame, 0, level), {}, parameters, second);
  RefineMesh own;
  if (!node.all) own = at_home(refined, node.cell, frame);
  RefineMesh& result = node.all ? refined : own;
  counts = first;
  counts.add(second);
  counts.pairs_before = first.pairs_before;
  counts.pairs_left = second.pairs_left;
  std::optional<MeshDistance> from_mesh;
  for_each_index(2, [&](std::size_t i) {
    if (i == 0)
      from_mesh.emplace(mesh);
    else
      keep_farthest_samples(result, counts);
  });
  counts.worst = largest_distance(result, MeasuredPoints::all, *from_mesh, counts.worst);
  counts.worst =
      largest_distance(mesh, MeasuredPoints::long_edges, MeshDistance(refined), counts.worst);
  return std::move(result);
}

std::uint64_t coarsen_bytes(const MeshSize& all) {
  MeshSize own = all;
  own.samples += own.vertices;  // of which each that goes or moves leaves one
  // The second pass holds what the first has made. Later there are only what it made itself and what of that is
  // at home.
  return refine_bytes(all, own, triangles_at_once) + MeshDistance::bytes(all.triangles) +
         mesh_bytes(own.vertices, own.triangles, own.samples, own.sided);
}

}  // namespace voxweld
