#include "pipeline/filter/piece_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "pipeline/filter/in_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint64_t piece_band_bytes = std::uint64_t{8} << 20;  // of samples, read at once
constexpr std::int64_t most_band_blocks = 16;

// The volume's blocks, and runs of them along x that are read at once: bands.
struct PieceBlocks {
  Index3 volume, blocks;
  std::int64_t side, length, runs;  // blocks of a band at most, bands of a row of blocks

  PieceBlocks(const VolumeInfo& info, std::int64_t block_side)
      : volume(info.geometry.size), side(block_side) {
    blocks = pieces_of({{}, volume}, splat(side)).hi;
    const auto block_bytes =
        static_cast<std::uint64_t>(side * side * side) * sample_bytes(info.type);
    length = std::clamp(static_cast<std::int64_t>(piece_band_bytes / block_bytes), std::int64_t{1},
                        most_band_blocks);
    runs = (blocks.x + length - 1) / length;
  }
  std::uint64_t bands() const { return static_cast<std::uint64_t>(runs * blocks.y * blocks.z); }
  // In blocks.
  Box3 band(std::uint64_t i) const {
    const auto at = static_cast<std::int64_t>(i);
    const std::int64_t x = at % runs * length, y = at / runs % blocks.y, z = at / runs / blocks.y;
    return {{x, y, z}, {std::min(blocks.x, x + length), y + 1, z + 1}};
  }
  Box3 samples(const Box3& of_blocks) const {
    return {of_blocks.lo * side, min(of_blocks.hi * side, volume)};
  }
};

struct BandDigest {
  std::vector<BlockDigest> blocks;
  StoredRange range;
};

// Puts the bands together, in their order.
class PieceAssembly {
 public:
  PieceAssembly(const PieceRule& rule, const PieceBlocks& grid, SampleType type,
                PieceLedger& ledger, std::uint64_t most_bytes, std::uint64_t memory)
      : rule_(rule),
        grid_(grid),
        type_(type),
        ledger_(ledger),
        join_(grid.blocks),
        most_bytes_(most_bytes),
        memory_(memory) {}

  void add(BandDigest&& band) {
    found_.range = merge(type_, found_.range, band.range);
    for (BlockDigest& block : band.blocks) add(block);
  }
  const FoundPieces& finish() {
    if (found_.spared) {
      --found_.tally.changed_pieces;
      found_.tally.changed_samples -= largest_.samples;
    }
    return found_;
  }

 private:
  void add(BlockDigest& block) {
    ledger_.add_block(block);
    found_.tally += block.closed;
    if (block.closed.pieces > 0) offer(block.largest, {layer_, block_, block.largest_piece});
    if (block.nodes.size() > PieceJoin::most_nodes - join_.nodes()) refuse();
    join_.add(block.nodes, std::move(block.faces));
    if (join_.bytes() > most_bytes_) refuse();
    ++block_;
    if (block_ % static_cast<std::uint64_t>(grid_.blocks.x * grid_.blocks.y) == 0) end_layer();
  }

  void end_layer() {
    std::vector<std::uint8_t> changes;
    const JoinedLayer layer = join_.end_layer([&](std::uint32_t group, const PieceFacts& facts) {
      changes.resize(group + std::size_t{1});
      changes[group] = found_.tally.judge(rule_, facts) ? 1 : 0;
      offer(facts, {layer_, {}, group});
    });
    changes.resize(layer.next.size());
    ledger_.end_layer(layer, changes);
    ++layer_;
  }

  void offer(const PieceFacts& facts, const PiecePlace& place) {
    if (!keeps_largest(rule_) || !is_larger(facts, largest_)) return;
    largest_ = facts;
    found_.spared = place;
  }

  [[noreturn]] void refuse() const {
    const auto layer = static_cast<std::int64_t>(layer_);
    throw InputError(
        fmt::format("{}: there are too many pieces for the memory: in slices {} to {}, {} or more "
                    "of them reach "
                    "from block to block and take {}; run.memory is {}, which leaves {} for them: "
                    "set run.memory "
                    "to {} or more, or smooth the volume before",
                    filter_name(rule_), layer * grid_.side,
                    std::min((layer + 1) * grid_.side, grid_.volume.z) - 1, join_.nodes(),
                    readable_bytes(static_cast<double>(join_.bytes())), exact_bytes(memory_),
                    readable_bytes(static_cast<double>(most_bytes_)), exact_bytes(enough())));
  }
  // Were the rest of the layer like what was seen of it.
  std::uint64_t enough() const {
    const auto slice = static_cast<std::uint64_t>(grid_.blocks.x * grid_.blocks.y);
    const std::uint64_t seen = block_ % slice + 1;
    const std::uint64_t wanted = join_.bytes() / seen * slice + (std::uint64_t{1} << 20);
    const std::uint64_t total = memory_ + (wanted > most_bytes_ ? wanted - most_bytes_ : 0);
    return ((total >> 20) + 1) << 20;
  }

  const PieceRule& rule_;
  const PieceBlocks& grid_;
  SampleType type_;
  PieceLedger& ledger_;
  PieceJoin join_;
  std::uint64_t most_bytes_, memory_;
  std::uint64_t layer_ = 0, block_ = 0;
  FoundPieces found_;
  PieceFacts largest_;
};

// What a worker keeps from one band to the next.
struct PieceWorker {
  std::vector<std::byte> samples;
  BlockMask mask;
  BlockLabels labels;
};

BandDigest digest_band(const PieceRule& rule, const SampleSource& source, const PieceBlocks& grid,
                       const Box3& band, PieceWorker& worker, WorkerContext& context) {
  const SampleType type = source.info().type;
  const Box3 box = grid.samples(band);
  worker.samples.resize(static_cast<std::size_t>(box.count()) * sample_bytes(type));
  source.read(box, worker.samples.data());
  BandDigest digest;
  each_index(band, [&](Index3 at) {
    context.check_interrupt();
    const Box3 block = grid.samples({at, at + splat(1)});
    mask_samples(type, worker.samples, box.size(), {block.lo - box.lo, block.hi - box.lo},
                 side_of(rule), worker.mask, &digest.range);
    digest.blocks.push_back(digest_block(rule, worker.mask, worker.labels, block, grid.volume));
  });
  context.add_bytes(worker.samples.size());
  return digest;
}

// A worker has its band, what finding takes, and its part of the bands that wait for their turn.
StageMemory pass_memory(const PieceRule& rule, const VolumeInfo& info, const PieceBlocks& grid,
                        std::size_t ahead) {
  const auto blocks = static_cast<std::uint64_t>(std::min(grid.length, grid.blocks.x));
  const auto block = static_cast<std::uint64_t>(grid.side * grid.side * grid.side);
  const std::uint64_t digests = std::min(most_digest_bytes, block * 8 + 1024) * blocks;
  // The least that a layer may take: its faces, with a few pieces on each. And the units.
  const auto layer =
      static_cast<std::uint64_t>(grid.blocks.x * grid.blocks.y * (64 + 128 * grid.side));
  const std::uint64_t units = grid.bands() * (sizeof(Unit) + sizeof(std::size_t));
  return {filter_name(rule),
          layer + units,
          0,
          "the pieces of one band of blocks",
          "raise run.memory",
          blocks * block * sample_bytes(info.type) + info.largest_decode + digest_scratch_bytes +
              (ahead + 1) * digests};
}

}  // namespace

FoundPieces pass_over_pieces(RunContext& context, const SampleSource& source, const PieceRule& rule,
                             std::int64_t side, PieceLedger& ledger) {
  constexpr std::size_t ahead = 2;  // bands a worker
  const VolumeInfo& info = source.info();
  const PieceBlocks grid(info, side);
  StageRun run;
  run.stage = filter_name(rule);
  run.noun = "bands";
  run.order = UnitOrder::as_given;
  run.memory = pass_memory(rule, info, grid, ahead);
  const int threads = stage_threads(context, run.memory);
  const auto workers_of = static_cast<std::uint64_t>(threads);
  const std::uint64_t total = context.budget().total;
  const std::uint64_t taken = program_bytes() + workers_of * run.memory.per_worker_bytes;
  PieceAssembly assembly(rule, grid, info.type, ledger,
                         std::max(total > taken ? total - taken : 0, run.memory.base_bytes), total);
  InOrder<BandDigest> order(workers_of * ahead, context.interrupt,
                            [&](std::size_t, BandDigest&& band) { assembly.add(std::move(band)); });
  std::vector<std::unique_ptr<PieceWorker>> workers;
  workers.reserve(workers_of);
  for (int i = 0; i < threads; ++i) workers.push_back(std::make_unique<PieceWorker>());
  std::vector<Unit> units;
  for (std::uint64_t i = 0; i < grid.bands(); ++i) {
    const Box3 box = grid.samples(grid.band(i));
    units.push_back({i, fmt::format("slice {}", box.lo.z), static_cast<double>(box.count())});
  }
  run_stage(context, run, units, threads, [&](const Unit& unit, WorkerContext& context_of) {
    try {
      if (!order.begin(unit.key)) return;
      PieceWorker& worker = *workers[static_cast<std::size_t>(context_of.slot())];
      order.finish(unit.key,
                   digest_band(rule, source, grid, grid.band(unit.key), worker, context_of));
    } catch (...) {
      order.fail();
      throw;
    }
  });
  return assembly.finish();
}

}  // namespace voxweld
