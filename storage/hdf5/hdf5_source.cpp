#include "storage/hdf5/hdf5_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "storage/hdf5/dataset_blocks.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/error.h"
#include "storage/types/chunked_access.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr std::uint64_t most_cached_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t most_cached_blocks = 256;

// Distances of neighbouring samples in each dimension, the last fastest.
std::vector<std::int64_t> strides_of(const std::vector<std::int64_t>& sides) {
  std::vector<std::int64_t> strides(sides.size(), 1);
  for (std::size_t d = sides.size(); d-- > 1;) strides[d - 1] = strides[d] * sides[d];
  return strides;
}

std::size_t dimension_of(const VolumePlace& place, int axis) {
  return static_cast<std::size_t>(place.dimension[static_cast<std::size_t>(axis)]);
}
bool has_dimension(const VolumePlace& place, int axis) {
  return place.dimension[static_cast<std::size_t>(axis)] >= 0;
}

// Where the first sample lies in the file, where the volume lies there as a raw file has it.
std::optional<std::uint64_t> raw_offset(const Hdf5File& file, const FoundVolume& found) {
  const DatasetFacts& facts = found.facts;
  if (facts.storage != StorageKind::contiguous || !facts.type.plain || !facts.external.empty())
    return {};
  const haddr_t begin = H5Dget_offset(found.dataset.get());
  if (begin == HADDR_UNDEF) return {};  // never written
  const Index3 size = found.info.geometry.size;
  const std::vector<std::int64_t> strides = strides_of(facts.dims);
  std::int64_t expected = 1, first = 0;
  for (int a = 0; a < 3; ++a) {
    if (has_dimension(found.place, a) && size[a] > 1 &&
        strides[dimension_of(found.place, a)] != expected)
      return {};
    expected *= size[a];
  }
  for (std::size_t d = 0; d < strides.size(); ++d) first += strides[d] * found.place.at[d];
  const std::uint64_t width = sample_bytes(found.info.type);
  const std::uint64_t at = begin + static_cast<std::uint64_t>(first) * width;
  const std::uint64_t bytes = static_cast<std::uint64_t>(expected) * width;
  if (begin > file.bytes().size() || at > file.bytes().size() || file.bytes().size() - at < bytes)
    throw FormatError(
        fmt::format("{}: truncated: its {} bytes of samples begin at byte {}, but the "
                    "file has {}: get a complete copy",
                    file.where("dataset", facts.path), bytes, at, file.bytes().size()));
  return at;
}

struct Block {
  std::unique_ptr<std::byte[]> samples;  // null: all are the fill value
};

class BlockSource final : public SampleSource {
 public:
  BlockSource(std::shared_ptr<const Hdf5File> file, FoundVolume found)
      : info_(std::move(found.info)),
        place_(found.place),
        blocks_(std::move(file), found),
        width_(sample_bytes(info_.type)),
        cached_(std::clamp<std::uint64_t>(most_cached_bytes / blocks_.block_bytes(), 1,
                                          most_cached_blocks)),
        cache_(static_cast<std::size_t>(cached_)),
        strides_(strides_of(blocks_.block())) {
    const Index3 size = info_.geometry.size;
    for (int a = 0; a < 3; ++a) {
      side_[a] = has_dimension(place_, a) ? blocks_.block()[dimension_of(place_, a)] : 1;
      step_[a] = has_dimension(place_, a) ? strides_[dimension_of(place_, a)] : 0;
    }
    info_.chunk = min(side_, size);
    info_.access = chunked_access(size, side_);
    info_.largest_decode = (cached_ + 1) * blocks_.block_bytes() + blocks_.scratch_bytes();
    if (blocks_.stored_count() < blocks_.count())
      info_.warnings.push_back(
          fmt::format("{}: {} of {} chunks are stored; where one is missing all samples have the "
                      "fill value",
                      info_.files.front().path, blocks_.stored_count(), blocks_.count()));
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    each_index(pieces_of(box, side_), [&](Index3 piece) { copy(piece, box, out); });
  }

 private:
  std::shared_ptr<const Block> block_at(Index3 piece) const {
    const Index3 count = divide(info_.geometry.size - splat(1), side_) + splat(1);
    const auto key = static_cast<std::uint64_t>((piece.z * count.y + piece.y) * count.x + piece.x);
    return cache_.get(key, [&] {
      std::vector<std::int64_t> first = place_.at;
      for (std::size_t d = 0; d < first.size(); ++d) first[d] -= first[d] % blocks_.block()[d];
      for (int a = 0; a < 3; ++a)
        if (has_dimension(place_, a)) first[dimension_of(place_, a)] = piece[a] * side_[a];
      return std::make_shared<const Block>(Block{blocks_.load(first)});
    });
  }

  // The part of the box that the piece holds.
  void copy(Index3 piece, const Box3& box, std::byte* out) const {
    const Index3 lo{piece.x * side_.x, piece.y * side_.y, piece.z * side_.z};
    const Box3 part = intersect(box, {lo, lo + side_});
    const std::shared_ptr<const Block> block = block_at(piece);
    // Of the other dimensions: the index within the block.
    std::int64_t base = 0;
    for (std::size_t d = 0; d < place_.at.size(); ++d)
      base += place_.at[d] % blocks_.block()[d] * strides_[d];
    const Index3 size = box.size();
    for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
      for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
        const Index3 to = Index3{part.lo.x, y, z} - box.lo, from = Index3{part.lo.x, y, z} - lo;
        std::byte* row =
            out + static_cast<std::size_t>((to.z * size.y + to.y) * size.x + to.x) * width_;
        const std::int64_t at = base + from.x * step_.x + from.y * step_.y + from.z * step_.z;
        copy_row(block->samples.get(), at, static_cast<std::size_t>(part.size().x), row);
      }
  }

  void copy_row(const std::byte* samples, std::int64_t at, std::size_t count,
                std::byte* row) const {
    const auto step = static_cast<std::size_t>(step_.x) * width_;
    const std::byte* from = samples == nullptr ? blocks_.fill().data()
                                               : samples + static_cast<std::size_t>(at) * width_;
    if (samples != nullptr && step == width_) {
      std::memcpy(row, from, count * width_);
      return;
    }
    const std::size_t stride = samples == nullptr ? 0 : step;
    dispatch_sample_type(info_.type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      for (std::size_t i = 0; i < count; ++i)
        std::memcpy(row + i * sizeof(T), from + i * stride, sizeof(T));
    });
  }

  VolumeInfo info_;
  VolumePlace place_;
  DatasetBlocks blocks_;
  std::size_t width_;
  std::uint64_t cached_;
  mutable BoundedCache<Block> cache_;
  std::vector<std::int64_t> strides_;  // within a block
  Index3 side_, step_;                 // of a block, and in it, along x, y, z
};

// The files that samples lie in beside the one that was named.
void note_files(const Hdf5File& file, const DatasetFacts& facts, VolumeInfo& info) {
  info.files.push_back({file.path(), file.bytes().state()});
  const auto note = [&](const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::equivalent(path, file.path(), error) || error) return;
    if (const auto state = file_state(path)) info.files.push_back({path.string(), *state});
  };
  note(facts.holder);
  for (const std::string& name : facts.external)
    note(std::filesystem::path(facts.holder).parent_path() / name);
}

}  // namespace

std::unique_ptr<SampleSource> make_hdf5_source(std::shared_ptr<const Hdf5File> file,
                                               FoundVolume found) {
  const Hdf5Lock lock;
  note_files(*file, found.facts, found.info);
  // Links may lead into another file: there its offsets are counted.
  const bool here = found.info.files.size() == 1;
  if (const auto offset = here ? raw_offset(*file, found) : std::nullopt) {
    DataLayout layout;
    layout.parts = {{file->path(), *offset, 0}};
    layout.byte_order = found.facts.type.order;
    return make_raw_source(std::move(found.info), layout);
  }
  return std::make_unique<BlockSource>(std::move(file), std::move(found));
}

}  // namespace voxweld
