#include "pipeline/run/shard_builder.h"

#include <algorithm>

#include "stages/geometry/inside_test.h"

namespace voxweld {
namespace {

// Bricks are read several at a time along x, as long as their samples stay under this.
constexpr std::uint64_t run_bytes = std::uint64_t{16} << 20;

// What a shard's own reduction finds final.
struct NodeCollector : ReductionSink {
  ShardNode* node = nullptr;
  ShardSummary* summary = nullptr;
  int brick_level = 0;

  void leaf(CellKey key, const RootRecord& record) override {
    BrickCounts& counts = summary->counts;
    ++counts.vertices;
    ++counts.leaves[static_cast<std::size_t>(key.level)];
    counts.worst_residual = std::max(counts.worst_residual, static_cast<double>(record.residual));
    if (key.level > brick_level)
      node->leaves.push_back(
          {key.code(), static_cast<std::uint32_t>(key.level), record.vertex, record.residual, 0});
  }
  void cube(const CubeCount& count) override { node->cubes.push_back(count); }
};

Box3 halo(const BuildJob& job, Index3 brick) {
  const int level = job.grid.brick_level();
  return halo_samples({brick * (std::int64_t{1} << level), level}, job.parameters);
}

Box3 brick_samples(const BuildJob& job, Index3 brick) {
  return intersect(halo(job, brick), Box3{{}, job.grid.size()});
}

void add(const BrickCounts& from, BrickCounts& to, bool own_leaves) {
  to.active_cells += from.active_cells;
  to.crossing_edges += from.crossing_edges;
  if (!own_leaves) return;
  to.vertices += from.vertices;
  for (std::size_t l = 0; l < from.leaves.size(); ++l) to.leaves[l] += from.leaves[l];
  to.worst_residual = std::max(to.worst_residual, from.worst_residual);
  to.worst_finest = std::max(to.worst_finest, from.worst_finest);
}

}  // namespace

std::uint64_t ShardBuilder::memory_bytes(const BrickGrid& grid, SampleType type) {
  const std::uint64_t side =
      (std::uint64_t{1} << grid.brick_level()) + 2 + 2 * (gradient_halo + label_halo);
  const std::uint64_t one = side * side * side * sample_bytes(type);
  const std::uint64_t side16 = std::uint64_t{1} << (grid.shard_level() - block_level);
  return std::max(one, run_bytes) + build_brick_bytes(grid.brick_level()) +
         side16 * side16 * side16 * 2 * sizeof(CubeCount);
}

Box3 ShardBuilder::shard_samples(const BuildJob& job, Index3 shard) {
  const Box3 bricks = job.grid.shard_bricks(shard);
  const Box3 first = halo(job, bricks.lo), last = halo(job, bricks.hi - splat(1));
  return intersect({first.lo, last.hi}, Box3{{}, job.grid.size()});
}

Bounds ShardBuilder::shard_bounds(const BuildJob& job, Index3 shard) {
  const int level = job.grid.brick_level();
  const Box3 bricks = job.grid.shard_bricks(shard);
  const auto bounds = [&](Index3 brick) {
    return brick_bounds({brick * (std::int64_t{1} << level), level}, job.parameters.spacing);
  };
  return {bounds(bricks.lo).lo, bounds(bricks.hi - splat(1)).hi};
}

namespace {

// Ranges of 64-bit integers are rounded outward, so one value alone may stand for its neighbours.
NodeState label_state(const ValueRange& range, double label, bool in_ring) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (range.empty || label < range.lo || label > range.hi) return NodeState::outside;
  const bool alone = range.lo == label && range.hi == label && label < exact;
  return alone && !in_ring ? NodeState::inside : NodeState::split;
}

// Of one complex of all labels: known only where nothing but labels left out is there.
NodeState labels_state(const ValueRange& range, const MaterialRules& rules) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (range.empty) return NodeState::outside;
  const bool one = range.lo == range.hi && range.lo >= 0 && range.lo < exact;
  return one && rules.of(static_cast<std::uint64_t>(range.lo)) == exterior ? NodeState::outside
                                                                           : NodeState::split;
}

}  // namespace

// Of the cells' corners: lattice point u is sample u - 1.
Box3 ShardBuilder::touched_samples(Index3 brick) const {
  const std::int64_t side = std::int64_t{1} << job_.grid.brick_level();
  const Index3 lo = brick * side - splat(1);
  return {lo, lo + splat(side + 1)};
}

bool ShardBuilder::meets_ring(Index3 brick) const {
  const Box3 touched = touched_samples(brick);
  return intersect(touched, Box3{{}, job_.grid.size()}) != touched;
}

// What is known of a brick without reading it: the ranges, then the edits that reach it.
NodeState ShardBuilder::skip_state(Index3 brick) const {
  const NodeState unedited = unedited_state(brick);
  if (job_.parameters.edits.empty()) return unedited;
  const int level = job_.grid.brick_level();
  const BrickPlace place{brick * (std::int64_t{1} << level), level};
  const Bounds bounds = brick_bounds(place, job_.parameters.spacing);
  const Relation before = unedited == NodeState::inside    ? Relation::inside
                          : unedited == NodeState::outside ? Relation::outside
                                                           : Relation::mixed;
  switch (side_after(job_.parameters.edits, bounds, before)) {
    case Relation::outside:
      return NodeState::outside;
    case Relation::inside:
      // Of labels one would have to know which.
      return meets_ring(brick) || job_.parameters.labels.mode != LabelMode::off ? NodeState::split
                                                                                : NodeState::inside;
    case Relation::mixed:
      break;
  }
  return NodeState::split;
}

// Whether the known ranges say that no cell of the brick has a sign change: all samples its cells
// touch, upper planes and the ring included, are on one side. `split` means: read it.
NodeState ShardBuilder::unedited_state(Index3 brick) const {
  const Box3 touched = touched_samples(brick);
  const Box3 real = intersect(touched, Box3{{}, job_.grid.size()});
  if (real.empty()) return NodeState::outside;
  if (job_.volume.ranges == nullptr) return NodeState::split;
  const bool in_ring = real != touched;
  const ValueRange range = job_.volume.ranges->range(real);
  const SurfaceParameters& surface = job_.parameters.surface;
  if (job_.parameters.labels.mode != LabelMode::off)
    return labels_state(range, *job_.parameters.labels.rules);
  if (surface.label) return label_state(range, static_cast<double>(*surface.label), in_ring);
  const bool above = surface.inside == Inside::above;
  // Ranges are rounded outward where a double cannot hold the value, so strict comparisons decide.
  const bool all_out =
      range.empty || (above ? range.hi < surface.isovalue : range.lo > surface.isovalue);
  const bool all_in = !range.empty && !range.any_nan && !in_ring &&
                      (above ? range.lo >= surface.isovalue : range.hi <= surface.isovalue);
  return all_out ? NodeState::outside : all_in ? NodeState::inside : NodeState::split;
}

// The bricks row, row + 1 .. end - 1 along x: maximal runs of those that must be read, cut where
// the samples would become too many.
std::vector<ShardBuilder::Run> ShardBuilder::runs_of(Index3 row, std::int64_t end) const {
  const std::uint64_t size = sample_bytes(job_.volume.source->info().type);
  std::vector<Run> runs;
  for (Index3 brick = row; brick.x < end; ++brick.x) {
    if (skip_state(brick) != NodeState::split) continue;
    const Box3 samples = brick_samples(job_, brick);
    if (!runs.empty() && runs.back().first.x + runs.back().count == brick.x) {
      Box3 joined = runs.back().samples;
      joined.hi.x = samples.hi.x;
      if (static_cast<std::uint64_t>(joined.count()) * size <= run_bytes) {
        runs.back().samples = joined;
        ++runs.back().count;
        continue;
      }
    }
    runs.push_back({brick, 1, samples});
  }
  return runs;
}

template <class F>
void ShardBuilder::each_run(Index3 shard, F&& f) {
  const Box3 bricks = job_.grid.shard_bricks(shard);
  for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)
    for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
      for (const Run& run : runs_of({bricks.lo.x, y, z}, bricks.hi.x)) f(run);
}

// A brick that is not read may change sides without a sample changing in those that are.
void ShardBuilder::note_sides(Index3 shard, StreamHasher& hash) const {
  const Box3 bricks = job_.grid.shard_bricks(shard);
  for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)
    for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
      for (std::int64_t x = bricks.lo.x; x < bricks.hi.x; ++x) {
        const NodeState state = skip_state({x, y, z});
        hash.update(std::as_bytes(std::span(&state, 1)));
      }
}

void ShardBuilder::read(const Run& run, StreamHasher& hash) {
  const std::size_t size = sample_bytes(job_.volume.source->info().type);
  samples_.resize(static_cast<std::size_t>(run.samples.count()) * size);
  if (!run.samples.empty()) job_.volume.source->read(run.samples, samples_.data());
  hash.update(std::as_bytes(std::span(&run.samples, 1)));
  hash.update(samples_);
}

Hash128 ShardBuilder::input_hash(Index3 shard) {
  StreamHasher hash;
  note_sides(shard, hash);
  each_run(shard, [&](const Run& run) { read(run, hash); });
  return hash.finish();
}

void ShardBuilder::build(Index3 shard, const WorkerContext& worker) {
  roots_.clear();
  summary_ = ShardSummary{};
  StreamHasher hash;
  note_sides(shard, hash);
  ShardArtifactWriter out(shard_artifact_path(job_, shard), shard_key(job_, shard),
                          job_.volume.stamp(shard_samples(job_, shard)));
  each_run(shard, [&](const Run& run) {
    read(run, hash);
    build_run(run, out, worker);
  });
  summary_.input = hash.finish();
  const std::vector<ShardNode> nodes = reduce(shard);
  out.finish(summary_, nodes);
}

void ShardBuilder::build_run(const Run& run, ShardArtifactWriter& out,
                             const WorkerContext& worker) {
  const Index3 extent = run.samples.size();
  const HaloBlock block{job_.volume.source->info().type,
                        job_.grid.size(),
                        run.samples,
                        samples_.data(),
                        extent.x,
                        extent.x * extent.y};
  for (std::int64_t i = 0; i < run.count; ++i) {
    worker.check_interrupt();
    const CellKey key{job_.grid.brick_level(), run.first + Index3{i, 0, 0}};
    build_brick(block, {key.lo(), key.level}, job_.parameters, scratch_, brick_);
    const bool leaf = brick_.root.state == NodeState::leaf;
    add(brick_.counts, summary_.counts, !leaf);
    if (brick_.root.state == NodeState::outside) continue;
    roots_.push_back({{key, brick_.root, leaf ? brick_.polygons.size() : 0}, {}});
    if (brick_.root.state == NodeState::inside) continue;
    ++summary_.active_bricks;
    if (!leaf) roots_.back().blocks = brick_.blocks;
    out.brick(morton_encode(key.at), brick_);
  }
}

std::vector<ShardNode> ShardBuilder::reduce(Index3 shard) {
  const Box3 bricks = job_.grid.shard_bricks(shard);
  summary_.bricks = static_cast<std::uint64_t>(bricks.count());
  for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)  // those never read
    for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
      for (std::int64_t x = bricks.lo.x; x < bricks.hi.x; ++x) {
        if (skip_state({x, y, z}) != NodeState::inside) continue;
        RootRecord inside;
        inside.state = NodeState::inside;
        inside.corner_signs = 255;
        roots_.push_back({{{job_.grid.brick_level(), {x, y, z}}, inside, 0}, {}});
      }
  std::sort(roots_.begin(), roots_.end(),
            [](const Root& a, const Root& b) { return a.node.key.code() < b.node.key.code(); });

  std::vector<ShardNode> nodes;
  auto root = roots_.begin();
  for (const BrickGrid::Cube& cube : job_.grid.shard_cubes(shard)) {
    ShardNode node;
    node.key = cube.key;
    NodeCollector sink;
    sink.node = &node;
    sink.summary = &summary_;
    sink.brick_level = job_.grid.brick_level();
    OctreeReduction reduction(cube.key, job_.grid.domain_level(), job_.parameters, sink);
    for (; root != roots_.end() && cube.key.cells().contains(root->node.key.cells()); ++root) {
      reduction.push(root->node);
      if (root->node.record.state != NodeState::split) continue;
      std::uint32_t begin = 0;
      for (std::size_t b = 0; b < root->blocks.size(); ++b) {
        const BlockCount& block = root->blocks[b];
        if (block.vertices != 0 || block.polygon_end != begin)
          sink.cube({root->node.key.code() + (b << (3 * block_level)), block_level, block.vertices,
                     block.polygon_end - begin});
        begin = block.polygon_end;
      }
    }
    const NodeSummary reduced = reduction.finish();
    summary_.collapsed_above += reduction.collapsed();
    node.record = reduced.record;
    node.polygons = reduced.polygons;
    nodes.push_back(std::move(node));
  }
  return nodes;
}

}  // namespace voxweld
