#include "pipeline/build/shard_builder.h"

#include <algorithm>

#include "pipeline/build/common_material.h"
#include "pipeline/build/runs_ahead.h"
#include "pipeline/build/shard_builders.h"
#include "pipeline/stage/shard_memory.h"
#include "stages/contouring/inside_test.h"
#include "storage/types/sample_range.h"

namespace voxweld {
namespace {

Box3 brick_samples(const BuildJob& job, Index3 brick) {
  return intersect(halo_samples(place_of_brick(job.grid, brick), job.parameters),
                   Box3{{}, job.grid.size()});
}

// Ranges of 64-bit integers are rounded outward, so one value alone may stand for its neighbours.
NodeState label_state(const ValueRange& range, double label, bool in_ring) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (range.empty || label < range.lo || label > range.hi) return NodeState::outside;
  const bool alone = range.lo == label && range.hi == label && label < exact;
  return alone && !in_ring ? NodeState::inside : NodeState::split;
}

}  // namespace

// Of the cells' corners: lattice point u is sample u - 1.
Box3 ShardBuilder::touched_samples(Index3 brick) const {
  const std::int64_t side = std::int64_t{1} << job_.grid.brick_level();
  const Index3 lo = brick * side - splat(1);
  return {lo, lo + splat(side + 1)};
}

Bounds ShardBuilder::bounds_of(Index3 brick) const {
  return brick_bounds(place_of_brick(job_.grid, brick), job_.parameters.spacing);
}

bool ShardBuilder::meets_ring(Index3 brick) const {
  const Box3 touched = touched_samples(brick);
  return intersect(touched, Box3{{}, job_.grid.size()}) != touched;
}

// What is known of a brick without reading it: the ranges, then the edits that reach it.
ShardBuilder::KnownBrick ShardBuilder::find_known(Index3 brick) const {
  if (job_.parameters.labels.mode != LabelMode::off) return known_label(brick);
  const NodeState unedited = unedited_state(brick);
  if (job_.parameters.edits.empty()) return {unedited, exterior};
  const Relation before = unedited == NodeState::inside    ? Relation::inside
                          : unedited == NodeState::outside ? Relation::outside
                                                           : Relation::mixed;
  switch (
      side_after(job_.parameters.edits, bounds_of(brick), before, sign_samples(job_.grid, brick))) {
    case Relation::outside:
      return {NodeState::outside, exterior};
    case Relation::inside:
      return {meets_ring(brick) ? NodeState::split : NodeState::inside, exterior};
    case Relation::mixed:
      break;
  }
  return {NodeState::split, exterior};
}

// The one material that all samples its cells touch are known to be of, ring apart, after the
// edits.
ShardBuilder::KnownBrick ShardBuilder::known_label(Index3 brick) const {
  const Box3 touched = touched_samples(brick);
  const Box3 real = intersect(touched, Box3{{}, job_.grid.size()});
  if (real.empty()) return {NodeState::outside, exterior};
  std::optional<Material> material;
  if (const auto range = range_of_brick(brick, real))
    material = common_material(*job_.parameters.labels.rules, *range);
  if (!job_.parameters.edits.empty())
    material = material_after(job_.parameters.edits, bounds_of(brick), material);
  if (!material || (*material != exterior && real != touched)) return {NodeState::split, exterior};
  if (*material == exterior) return {NodeState::outside, exterior};
  return {NodeState::inside, *material};
}

// Whether the known ranges say that no cell of the brick has a sign change: all samples its cells
// touch, upper planes and the ring included, are on one side. `split` means: read it.
NodeState ShardBuilder::unedited_state(Index3 brick) const {
  const Box3 touched = touched_samples(brick);
  const Box3 real = intersect(touched, Box3{{}, job_.grid.size()});
  if (real.empty()) return NodeState::outside;
  const std::optional<ValueRange> known = range_of_brick(brick, real);
  return known ? side_of(*known, real != touched) : NodeState::split;
}

// in_ring: whether its cells touch samples beyond the volume, too.
NodeState ShardBuilder::side_of(const ValueRange& range, bool in_ring) const {
  const SurfaceParameters& surface = job_.parameters.surface;
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
std::vector<BrickRow> ShardBuilder::runs_of(Index3 row, std::int64_t end) const {
  std::vector<BrickRow> runs;
  for (Index3 brick = row; brick.x < end; ++brick.x) {
    if (known_of(brick).state != NodeState::split) continue;
    const Box3 samples = brick_samples(job_, brick);
    if (!runs.empty() && runs.back().first.x + runs.back().count == brick.x) {
      Box3 joined = runs.back().samples;
      joined.hi.x = samples.hi.x;
      if (static_cast<std::uint64_t>(joined.count()) <= job_.memory.run_samples) {
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
      for (const BrickRow& run : runs_of({bricks.lo.x, y, z}, bricks.hi.x)) f(run);
}

template <class F>
void ShardBuilder::each_brick(Index3 shard, F&& f) const {
  const Box3 bricks = job_.grid.shard_bricks(shard);
  for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)
    for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
      for (std::int64_t x = bricks.lo.x; x < bricks.hi.x; ++x) f(Index3{x, y, z});
}

// samples: those its cells touch, in the volume.
std::optional<ValueRange> ShardBuilder::range_of_brick(Index3 brick, const Box3& samples) const {
  if (job_.volume.ranges() != nullptr) return job_.volume.ranges()->range(samples);
  return ranges_.of(brick);
}

void ShardBuilder::look_at(Index3 shard, Hash128 stamp, bool read_all) {
  shard_bricks_ = job_.grid.shard_bricks(shard);
  ranges_.open(shard, stamp, read_all);
  known_.clear();
  each_brick(shard, [&](Index3 brick) { known_.push_back(find_known(brick)); });
}

const ShardBuilder::KnownBrick& ShardBuilder::known_of(Index3 brick) const {
  const Index3 at = brick - shard_bricks_.lo, size = shard_bricks_.size();
  return known_[static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x)];
}

// A brick that is not read may change sides without a sample changing in those that are.
void ShardBuilder::note_sides(Index3 shard, StreamHasher& hash) const {
  each_brick(shard, [&](Index3 brick) {
    const KnownBrick& known = known_of(brick);
    hash.update(std::as_bytes(std::span(&known.state, 1)));
    if (known.material != exterior) hash.update(std::as_bytes(std::span(&known.material, 1)));
  });
}

Hash128 ShardBuilder::read(const BrickRow& run) {
  const std::size_t size = sample_bytes(job_.volume.source->info().type);
  samples_.resize(static_cast<std::size_t>(run.samples.count()) * size);
  if (!run.samples.empty()) job_.volume.source->read(run.samples, samples_.data());
  StreamHasher hash;
  hash.update(std::as_bytes(std::span(&run.samples, 1)));
  hash.update(samples_);
  return hash.finish();
}

// Of the run's own samples, so that no other run counts them too.
NanCount ShardBuilder::nans_of(const BrickRow& run) const {
  if (job_.volume.ranges() != nullptr || run.samples.empty()) return {};
  const std::int64_t side = std::int64_t{1} << job_.grid.brick_level();
  const Box3 own{run.first * side, (run.first + Index3{run.count, 1, 1}) * side};
  return count_nans(job_.volume.source->info().type, samples_, run.samples,
                    intersect(own, run.samples));
}

std::vector<BrickRange> ShardBuilder::ranges_of(const BrickRow& run) const {
  std::vector<BrickRange> ranges;
  if (job_.ranges.empty()) return ranges;
  for (std::int64_t i = 0; i < run.count; ++i) {
    const Index3 brick = run.first + Index3{i, 0, 0};
    const Box3 touched = intersect(touched_samples(brick), Box3{{}, job_.grid.size()});
    const SampleType type = job_.volume.source->info().type;
    ranges.push_back(BrickRange::make(
        morton_encode(brick),
        touched.empty() ? ValueRange{} : range_of(type, samples_, run.samples, touched)));
  }
  return ranges;
}

// Of each of the run's bricks as its range tells, where there are ranges and nothing else has a say.
std::vector<NodeState> ShardBuilder::sides_of(const BrickRow& run,
                                              std::span<const BrickRange> ranges) const {
  std::vector<NodeState> sides(static_cast<std::size_t>(run.count), NodeState::split);
  if (job_.parameters.labels.mode != LabelMode::off || !job_.parameters.edits.empty()) return sides;
  for (std::size_t i = 0; i < ranges.size(); ++i)
    sides[i] = side_of(ranges[i].range(), meets_ring(morton_decode(ranges[i].brick)));
  return sides;
}

HaloBlock ShardBuilder::block_of(const BrickRow& run) const {
  const Index3 extent = run.samples.size();
  return {job_.volume.source->info().type,
          job_.grid.size(),
          run.samples,
          samples_.data(),
          extent.x,
          extent.x * extent.y};
}

Hash128 ShardBuilder::input_hash(Index3 shard, bool read_all) {
  look_at(shard, job_.volume.stamp(shard_samples(job_, shard)), read_all);
  StreamHasher hash;
  note_sides(shard, hash);
  each_run(shard, [&](const BrickRow& run) {
    const Hash128 samples = read(run);
    for (const BrickRange& range : ranges_of(run)) ranges_.add(range);
    hash.update(std::as_bytes(std::span(&samples, 1)));
  });
  ranges_.close();
  return hash.finish();
}

// Bricks whose edits are those of the earlier build are taken over, or cut; what is read is read in
// whole runs, unless all of one is taken over.
BuiltRun ShardBuilder::build_run(const BrickRow& run, const EarlierShard* earlier,
                                 const WorkerContext& worker) {
  std::vector<const BuiltBrick*> kept(static_cast<std::size_t>(run.count), nullptr);
  const auto brick = [&](std::size_t i) {
    return run.first + Index3{static_cast<std::int64_t>(i), 0, 0};
  };
  if (earlier != nullptr)
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = earlier->brick(brick(i));
  const bool all_kept = std::ranges::find(kept, nullptr) == kept.end();
  const BuiltRun* known = all_kept && earlier ? earlier->run(run.first, run.count) : nullptr;
  const BuiltRun built = known ? *known : BuiltRun{run.first, run.count, read(run)};
  std::vector<BrickRange> ranges;
  if (known == nullptr) {
    nans_.add(nans_of(run));
    ranges = ranges_of(run);
    for (const BrickRange& range : ranges) ranges_.add(range);
  }
  const std::vector<NodeState> sides = sides_of(run, ranges);
  const HaloBlock block = block_of(run);
  for (std::size_t i = 0; i < kept.size();) {
    std::size_t end = i;
    while (end < kept.size() && kept[end] == nullptr) ++end;
    if (end > i) octrees_->build({block, brick(i), std::span(sides).subspan(i, end - i)}, worker);
    bricks_.built += end - i;
    for (i = end; i < kept.size() && kept[i] != nullptr; ++i)
      take_over(brick(i), *kept[i], *earlier, worker);
  }
  return built;
}

void ShardBuilder::take_over(Index3 brick, const BuiltBrick& built, const EarlierShard& earlier,
                             const WorkerContext& worker) {
  if (earlier.is_finer()) {
    worker.check_interrupt();
    bricks_.bytes_cut += octrees_->cut(brick, built, earlier.artifact());
    ++bricks_.cut;
  } else {
    octrees_->keep(brick, built, earlier.artifact());
    ++bricks_.kept;
  }
}

std::unique_ptr<RunPieces> ShardBuilder::build_pieces(const BrickRow& run,
                                                      const WorkerContext& worker) {
  share_memory(worker);
  const MemoryShare::Use use(*share_);
  return pieces_of(run, worker);
}

std::unique_ptr<RunPieces> ShardBuilder::pieces_of(const BrickRow& run,
                                                   const WorkerContext& worker) {
  const MemoryShare::Hurry no_waiting(*share_);
  auto pieces = std::make_unique<RunPieces>();
  pieces->built = {run.first, run.count, read(run)};
  pieces->nans = nans_of(run);
  pieces->ranges = ranges_of(run);
  const std::vector<NodeState> sides = sides_of(run, pieces->ranges);
  RunPiecesSink sink(job_, *pieces);
  octrees_->build({block_of(run), run.first, sides}, worker, sink);
  pieces->loan = MemoryLoan::attempt(*worker.memory(), sink.bytes_held());
  if (!pieces->loan) throw NoMemoryLeft();
  return pieces;
}

void ShardBuilder::build(Index3 shard, Hash128 stamp, const EarlierShard* earlier,
                         const WorkerContext& worker) {
  // As the earlier build, so that its runs are those of this one.
  look_at(shard, stamp, earlier != nullptr && earlier->has_read_all());
  StreamHasher hash;
  note_sides(shard, hash);
  octrees_->begin(shard, stamp);
  const auto unread =
      ranges_.are_known()
          ? static_cast<std::uint64_t>(std::ranges::count_if(
                known_, [](const KnownBrick& b) { return b.state != NodeState::split; }))
          : 0;
  bricks_.unread += unread;
  std::vector<BrickRow> rows;
  each_run(shard, [&](const BrickRow& run) { rows.push_back(run); });
  RunsAhead::BuildRun by_helper;  // not of what is taken over or cut: nothing is read of that
  if (earlier == nullptr)
    by_helper = [&](const BrickRow& run) -> std::unique_ptr<RunPieces> {
      const ShardBuilders::Loan helper = others_.borrow_if_free();
      return helper ? helper->build_pieces(run, worker) : nullptr;
    };
  RunsAhead ahead(rows, worker, by_helper,
                  [&](const BrickRow& run) { return pieces_of(run, worker); });
  const MemoryShare::BeforeWaiting forgets(*share_, [&ahead] { ahead.stop(); });
  std::vector<BuiltRun> runs;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto pieces = ahead.take(i)) {
      octrees_->add_run(*pieces);
      bricks_.built += pieces->bricks.size();
      nans_.add(pieces->nans);
      for (const BrickRange& range : pieces->ranges) ranges_.add(range);
      runs.push_back(pieces->built);
    } else {
      runs.push_back(build_run(rows[i], earlier, worker));
    }
    hash.update(std::as_bytes(std::span(&runs.back().samples, 1)));
  }
  each_brick(shard, [&](Index3 brick) {
    const KnownBrick& known = known_of(brick);
    if (known.state == NodeState::inside) octrees_->inside(brick, known.material);
  });
  // First: a shard that is there is not built again, and would never have them.
  ranges_.close();
  octrees_->finish(hash.finish(), std::move(runs), unread);
}

void ShardBuilder::share_memory(const WorkerContext& worker) {
  if (share_) return;
  share_.emplace(worker.memory(), worker.interrupt(), [this] { octrees_->free_buffers(); });
  octrees_ = std::make_unique<ShardOctrees>(job_, *share_);
}

void ShardBuilder::build(Index3 shard, const WorkerContext& worker) {
  share_memory(worker);
  const MemoryShare::Use use(*share_);
  const BrickReport before = bricks_;
  const Hash128 stamp = job_.volume.stamp(shard_samples(job_, shard));
  const auto build_from = [&](const EarlierShard& earlier, bool may_fail) {
    try {
      build(shard, stamp, &earlier, worker);
      return true;
    } catch (const DamagedArtifact& damage) {
      if (!may_fail || damage.path() != earlier.artifact().path()) throw;
      bricks_ = before;
      return false;
    }
  };
  // Damage of what an extraction cuts is told: whoever runs this has it mended, and comes again.
  if (const auto finer = EarlierShard::open_finer(job_, shard, stamp);
      finer && build_from(*finer, job_.finer_may_fail))
    return;
  if (const auto earlier = EarlierShard::open(job_, shard, stamp);
      earlier && build_from(*earlier, true))
    return;
  build(shard, stamp, nullptr, worker);
}

}  // namespace voxweld
