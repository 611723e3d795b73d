#include "tests/paper/staged_contour.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "stages/build/brick_polygons.h"
#include "stages/build/label_edits.h"
#include "stages/build/label_field.h"
#include "stages/build/label_hermite.h"

namespace voxweld::paper {
namespace {

// As pipeline/build/shard_builder.cpp leaves out bricks of empty space.
bool known_outside(const ModelVolume& model, const BrickPlace& place) {
  if (!model.empty) return false;
  const Bounds bounds = brick_bounds(place, model.parameters.spacing);
  return side_after(model.parameters.edits, bounds, Relation::outside) == Relation::outside;
}

template <class F>
void each_brick(const ModelVolume& model, const BrickGrid& grid, F&& f) {
  const Index3 count = grid.bricks();
  for (Index3 at; at.z < count.z; ++at.z)
    for (at.y = 0; at.y < count.y; ++at.y)
      for (at.x = 0; at.x < count.x; ++at.x)
        if (!known_outside(model, place_of_brick(grid, at))) f(at);
}

void sample_edges(const ModelVolume& model, LabelField& labels, HermiteBrick& brick) {
  const HaloBlock block = model.block();
  const int side = brick.frame.side();
  if (!model.parameters.surface.label)
    return brick.edges.compute(block, brick.frame.origin, side, brick.signs, model.parameters);
  const Box3 box = intersect(Box3{brick.frame.origin - splat(1 + gradient_halo),
                                  brick.frame.origin + splat(side + gradient_halo)},
                             Box3{{}, block.size});
  brick.edges.compute_label(
      box.empty() ? block : labels.filter(block, *model.parameters.surface.label, box),
      brick.frame.origin, side, brick.signs, Box3{{}, splat(side + 1)}, model.parameters.spacing);
}

bool between_labels(const ModelVolume& model) {
  return model.parameters.labels.mode == LabelMode::shared;
}

RootRecord root_of_homogeneous(const SignGrid& signs) {
  RootRecord root;
  root.state = signs.inside(0, 0, 0) ? NodeState::inside : NodeState::outside;
  root.corner_signs = root.state == NodeState::inside ? 255 : 0;
  return root;
}
RootRecord root_of_homogeneous(const LabelGrid& labels) {
  RootRecord root;
  root.corners.fill(labels.materials()[labels.at(0, 0, 0)]);
  root.state = root.corners[0] == exterior ? NodeState::outside : NodeState::inside;
  return root;
}

// With the QEFs of all clusters, which build keeps of one block at a time.
std::uint64_t bytes_of(const BrickNodes& nodes, int levels) {
  constexpr std::uint64_t of_cluster = sizeof(SheetCluster) + sizeof(ClusterVertex) + sizeof(Qef);
  std::uint64_t bytes = 0;
  for (int l = 0; l <= levels; ++l) {
    const NodeLevel& level = nodes.level(l);
    bytes += 4 * (level.codes.size() + level.first_child.size() + level.first_cluster.size()) +
             2 * level.codes.size() + of_cluster * level.clusters.size();
  }
  return bytes;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

VolumeBricks no_bricks(const ModelVolume& model) {
  return {model.volume.size, model.parameters, model.options()};
}

namespace {

void find_cells(const ModelVolume& model, HermiteBrick& brick) {
  if (between_labels(model)) {
    brick.cells.count(brick.labels);
    brick.cells.find(brick.labels);
    brick.root = root_of_homogeneous(brick.labels);
  } else {
    brick.cells.count(brick.signs, brick.frame.side(), {{}, splat(brick.frame.side())});
    brick.cells.find(brick.signs);
    brick.root = root_of_homogeneous(brick.signs);
  }
}

void sample_labels(const ModelVolume& model, MaterialBlock& materials, LabelHermite& edges,
                   HermiteBrick& brick) {
  std::vector<Material> given;
  for (const Edit& edit : model.parameters.edits) given.push_back(edit.material);
  const BrickPlace place{brick.frame.origin, brick.frame.level};
  HaloBlock block = model.block();
  block.samples = intersect(block.samples, halo_samples(place, model.parameters));
  const Index3 lo = block.samples.lo;
  if (!block.samples.empty())
    block.data += static_cast<std::size_t>(lo.z * block.slice + lo.y * block.row + lo.x) *
                  sample_bytes(block.type);
  materials.fill(block, *model.parameters.labels.rules, given);
  brick.labels.fill(materials, place.origin, brick.frame.side());
  edges.compute(materials.block(), place.origin, brick.labels, model.parameters.spacing,
                brick.edges);
}

// The edit, but for the cells.
void apply_to_edges(const Edit& edit, const ModelVolume& model, HermiteBrick& brick) {
  const VolumeFrame volume{model.volume.size, model.parameters.spacing};
  const int side = brick.frame.side();
  if (between_labels(model))
    return LabelEdits().apply(edit, volume, brick.frame.origin, brick.labels, brick.edges);
  SignGrid solid;
  solid.fill(edit.solid, volume, brick.frame.origin, side);
  brick.signs.combine(edit.op, solid);
  HermiteEdges before;
  std::swap(brick.edges, before);
  brick.edges.compute(edit, volume, brick.frame.origin, side, brick.signs, solid, before);
}

}  // namespace

void apply(const Edit& edit, const ModelVolume& model, HermiteBrick& brick) {
  apply_to_edges(edit, model, brick);
  find_cells(model, brick);
}

std::vector<HermiteBrick> hermite_data(const ModelVolume& model, Homogeneous homogeneous) {
  std::vector<HermiteBrick> all;
  LabelField field;
  MaterialBlock materials;
  LabelHermite label_edges;
  const BrickGrid grid = no_bricks(model).grid();
  each_brick(model, grid, [&](Index3 at) {
    HermiteBrick& brick = all.emplace_back();
    const BrickPlace place = place_of_brick(grid, at);
    brick.at = at;
    brick.frame = {place.origin, place.level, domain_level(model.volume.size)};
    if (between_labels(model)) {
      sample_labels(model, materials, label_edges, brick);
    } else {
      brick.signs.fill(model.block(), place.origin, brick.frame.side(), model.parameters.surface);
      sample_edges(model, field, brick);
    }
    const Bounds bounds = brick_bounds(place, model.parameters.spacing);
    for (const Edit& edit : model.parameters.edits)
      if (edit_reaches(edit, bounds)) apply_to_edges(edit, model, brick);
    find_cells(model, brick);
    if (homogeneous == Homogeneous::forget && brick.cells.size() == 0)
      brick = {brick.at, brick.frame, {}, {}, {}, {}, brick.root};
  });
  return all;
}

void Simplifier::simplify(const HermiteBrick& brick, BrickOctree& out) {
  const int level = brick.frame.level;
  out = BrickOctree{};
  out.blocks.assign(std::size_t{1} << 3 * (level - block_level), BlockCount{});
  out.counts.active_cells = brick.cells.size();
  if (brick.cells.size() == 0)
    out.root = brick.root;
  else if (between_labels(model_))
    simplify(brick, brick.labels, out);
  else
    simplify(brick, brick.signs, out);
}

template <class Grid>
void Simplifier::simplify(const HermiteBrick& brick, const Grid& grid, BrickOctree& out) {
  build_octree(brick.frame, model_.volume.size, grid, brick.cells, brick.edges, model_.parameters,
               scratch_, out);
  node_bytes_ += bytes_of(scratch_.nodes, brick.frame.level);
}

VolumeBricks build_bricks(const ModelVolume& model) {
  VolumeBricks bricks = no_bricks(model);
  const BrickGrid grid = bricks.grid();
  BrickScratch scratch;
  each_brick(model, grid, [&](Index3 at) {
    build_brick(model.block(), place_of_brick(grid, at), model.parameters, scratch,
                bricks.octrees[morton_encode(at)]);
  });
  return bricks;
}

std::string difference(const VolumeBricks& a, const VolumeBricks& b) {
  if (a.octrees.size() != b.octrees.size()) return "the number of bricks";
  for (auto i = a.octrees.begin(), j = b.octrees.begin(); i != a.octrees.end(); ++i, ++j) {
    const BrickOctree &p = i->second, &q = j->second;
    if (i->first != j->first || !same_bytes(p.vertices, q.vertices) ||
        !same_bytes(p.polygons, q.polygons) || p.root.state != q.root.state)
      return fmt::format("brick {}", i->first);
  }
  return "";
}

}  // namespace voxweld::paper
