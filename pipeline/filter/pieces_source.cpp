#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <mutex>
#include <utility>

#include "pipeline/filter/pieces.h"
#include "stages/filter/block_pieces.h"
#include "stages/filter/stored_value.h"
#include "storage/artifact/piece_changes.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Boxes side by side have parts of one block: what changes of the last few is kept.
constexpr std::size_t kept_masks = 256;
constexpr std::uint64_t mask_bytes = most_block_side * most_block_side * sizeof(std::uint64_t);

SurfaceSide side_of(const PieceChangesSummary& summary) {
  SurfaceSide side{summary.isovalue, summary.below != 0 ? Inside::below : Inside::above,
                   summary.outside == 0};
  side.isovalue.rest = summary.isovalue_rest;
  return side;
}

// Of the labelled samples those that change.
BlockMask changed_samples(const BlockMask& mask, const BlockLabels& labels,
                          std::span<const std::uint64_t> bits) {
  BlockMask changed{mask.size, std::vector<std::uint64_t>(mask.rows.size())};
  labels.each_run([&](const PieceRun& run, std::uint32_t piece) {
    if ((bits[piece / 64] >> (piece % 64) & 1) == 0) return;
    changed.rows[run.row] |= ~std::uint64_t{0} >> (most_block_side - (run.end - run.begin))
                                                      << run.begin;
  });
  return changed;
}

// Sets the samples of `part` that have a bit in the block's mask. samples: those of `box`.
template <class T>
void set_samples(T* samples, const Box3& box, const Box3& part, const Box3& block,
                 const BlockMask& mask, T value) {
  const Index3 size = box.size();
  const std::int64_t skip = part.lo.x - block.lo.x;
  const std::uint64_t width = ~std::uint64_t{0} >> (most_block_side - (part.hi.x - part.lo.x));
  for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
    for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
      const std::int64_t row = y - block.lo.y + mask.size.y * (z - block.lo.z);
      T* first =
          samples + (part.lo.x - box.lo.x + size.x * (y - box.lo.y + size.y * (z - box.lo.z)));
      std::uint64_t bits = mask.rows[static_cast<std::size_t>(row)] >> skip & width;
      for (; bits != 0; bits &= bits - 1) first[std::countr_zero(bits)] = value;
    }
}

class PiecesSource final : public SampleSource {
 public:
  PiecesSource(std::shared_ptr<SampleSource> before, std::filesystem::path path, Hash128 key)
      : before_(std::move(before)), path_(std::move(path)), key_(key), info_(before_->info()) {
    const std::uint64_t block_bytes =
        mask_bytes / sizeof(std::uint64_t) * most_block_side * sample_bytes(info_.type);
    info_.access = Access::box;
    // A part of a block that changes costs the whole of it.
    for (int axis = 0; axis < 3; ++axis) {
      if (info_.chunk[axis] > most_block_side) continue;
      info_.chunk[axis] = most_block_side;
      info_.chunk_first[axis] = 0;
    }
    info_.largest_decode += block_bytes + label_bytes + 2 * mask_bytes + kept_masks * mask_bytes +
                            PieceChanges::memory_bytes;
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;
  void each_file(const Box3& box, const FileVisitor& f) const override {
    before_->each_file(box, f);
  }

 private:
  const PieceChanges& opened() const;
  void change(const PieceChanges& changes, const PieceChanges::Block& change, std::uint64_t number,
              const Box3& block, const Box3& box, std::byte* out) const;
  BlockMask find_changed(const PieceChanges::Block& change, SurfaceSide side, const Box3& block,
                         const Box3& box, const std::byte* out) const;

  std::shared_ptr<SampleSource> before_;
  std::filesystem::path path_;
  Hash128 key_;
  VolumeInfo info_;
  mutable std::mutex opening_;
  mutable std::unique_ptr<const PieceChanges> changes_;
  mutable BoundedCache<BlockMask> masks_{kept_masks};  // of blocks: the samples that change
};

const PieceChanges& PiecesSource::opened() const {
  const std::scoped_lock lock(opening_);
  if (changes_ != nullptr) return *changes_;
  if (!file_state(path_)) throw DamagedArtifact(path_.string(), "is missing");
  auto changes = std::make_unique<const PieceChanges>(path_);
  const PieceChangesSummary& summary = changes->summary();
  if (changes->key() != key_)
    throw DamagedArtifact(path_.string(), "was made from another input or for another filter");
  if (summary.size != info_.geometry.size || summary.type != static_cast<std::uint64_t>(info_.type))
    throw DamagedArtifact(path_.string(), "is of a volume of another size or type");
  changes_ = std::move(changes);
  return *changes_;
}

void PiecesSource::read(const Box3& box, std::byte* out) const {
  const PieceChanges& changes = opened();
  before_->read(box, out);
  const std::int64_t side = changes.summary().side;
  const Index3 size = info_.geometry.size;
  const Index3 blocks = pieces_of({{}, size}, splat(side)).hi;
  each_index(pieces_of(box, splat(side)), [&](Index3 at) {
    const auto number = static_cast<std::uint64_t>(at.x + blocks.x * (at.y + blocks.y * at.z));
    const auto found = changes.find(number);
    if (!found) return;
    change(changes, *found, number, {at * side, min((at + splat(1)) * side, size)}, box, out);
  });
}

void PiecesSource::change(const PieceChanges& changes, const PieceChanges::Block& change,
                          std::uint64_t number, const Box3& block, const Box3& box,
                          std::byte* out) const {
  const Box3 part = intersect(block, box);
  const SurfaceSide side = side_of(changes.summary());
  std::shared_ptr<const BlockMask> mask;
  Box3 of_mask = block;
  if (change.all) {
    BlockMask all;
    const auto held = static_cast<std::size_t>(box.count()) * sample_bytes(info_.type);
    mask_samples(info_.type, {out, held}, box.size(), {part.lo - box.lo, part.hi - box.lo}, side,
                 all);
    mask = std::make_shared<const BlockMask>(std::move(all));
    of_mask = part;
  } else {
    mask = masks_.get(number, [&] {
      return std::make_shared<const BlockMask>(find_changed(change, side, block, box, out));
    });
  }
  dispatch_sample_type(info_.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    set_samples(reinterpret_cast<T*>(out), box, part, of_mask, *mask,
                stored_value<T>(changes.summary().value));
  });
}

// out: the box's samples as they were, as far as they are of this block.
BlockMask PiecesSource::find_changed(const PieceChanges::Block& change, SurfaceSide side,
                                     const Box3& block, const Box3& box,
                                     const std::byte* out) const {
  BlockMask mask;
  if (box.contains(block)) {
    const auto held = static_cast<std::size_t>(box.count()) * sample_bytes(info_.type);
    mask_samples(info_.type, {out, held}, box.size(), {block.lo - box.lo, block.hi - box.lo}, side,
                 mask);
  } else {
    std::vector<std::byte> samples(static_cast<std::size_t>(block.count()) *
                                   sample_bytes(info_.type));
    before_->read(block, samples.data());
    mask_samples(info_.type, samples, block.size(), {{}, block.size()}, side, mask);
  }
  BlockLabels labels;
  labels.find(mask);
  if (labels.pieces() != change.pieces)
    throw DamagedArtifact(
        path_.string(),
        fmt::format("has {} pieces in the block at sample {}, {}, {}, and the volume {}: its "
                    "samples have changed since",
                    change.pieces, block.lo.x, block.lo.y, block.lo.z, labels.pieces()));
  return changed_samples(mask, labels, change.bits);
}

}  // namespace

std::shared_ptr<SampleSource> pieces_source(std::shared_ptr<SampleSource> before,
                                            std::filesystem::path path, Hash128 key) {
  return std::make_shared<PiecesSource>(std::move(before), std::move(path), key);
}

}  // namespace voxweld
