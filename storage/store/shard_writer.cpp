#include "storage/store/shard_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

// What an open file holds besides its index: the buffer of AtomicFile, hash state, bookkeeping.
constexpr std::uint64_t open_file_bytes = (std::uint64_t{1} << 18) + 8192;

// One shard file being written, chunks in C order.
class OpenShard {
 public:
  OpenShard(const StoreLayout& layout, Index3 shard, Hash128 key)
      : layout_(layout), shard_(shard), file_(layout.shard_path(shard)) {
    const auto count =
        static_cast<std::size_t>(layout.chunks() * layout.chunks() * layout.chunks());
    index_.resize(count);
    record_.key = key;
    record_.chunks.resize(count);
    record_.histogram.type = layout.type;
  }

  Box3 samples() const { return layout_.shard_samples(shard_); }

  void note_range(Index3 chunk, const ValueRange& range) { record_.chunks[number(chunk)] = range; }

  void append_chunk(Index3 chunk, std::span<const std::byte> encoded) {
    index_[number(chunk)] = {file_.size(), encoded.size()};
    append(encoded);
  }

  void add_histogram(const Histogram& part) { add(record_.histogram, part); }

  void commit(std::vector<std::byte>& buffer);

 private:
  std::size_t number(Index3 chunk) const {
    const Index3 at = chunk - shard_ * layout_.chunks();
    return static_cast<std::size_t>((at.z * layout_.chunks() + at.y) * layout_.chunks() + at.x);
  }
  void append(std::span<const std::byte> data) {
    file_.append(data);
    hasher_.update(data);
  }

  const StoreLayout& layout_;
  Index3 shard_;
  AtomicFile file_;
  StreamHasher hasher_;
  std::vector<ShardIndexEntry> index_;
  ShardRecord record_;
};

void OpenShard::commit(std::vector<std::byte>& buffer) {
  const auto entries = std::as_bytes(std::span(index_));
  buffer.assign(entries.begin(), entries.end());
  append_checksum(buffer);
  append(buffer);
  record_.file_size = file_.size();
  record_.file_hash = hasher_.finish();
  // An old record must never stand beside a new shard: the old key would then vouch for it.
  const auto record_path = layout_.record_path(shard_);
  remove_file(record_path);
  file_.commit(Durability::rename_only);
  write_shard_record(record_path, record_);
}

// Reads a run of shards band by band and hands each its chunks.
class RunWriter {
 public:
  RunWriter(const StoreLayout& layout, const SampleSource& source, SampleStatistics& statistics,
            ShardScratch& scratch)
      : layout_(layout),
        source_(source),
        statistics_(statistics),
        scratch_(scratch),
        zarr_(layout.zarr()),
        form_(zarr_.form()) {}

  void write(Index3 first, std::span<const Hash128> keys);

 private:
  void write_band(const Box3& band);
  void write_chunk(OpenShard& shard, Index3 chunk, const Box3& band);
  ValueRange gather(const Box3& box, const Box3& band);

  const StoreLayout& layout_;
  const SampleSource& source_;
  SampleStatistics& statistics_;
  ShardScratch& scratch_;
  const ZarrArray zarr_;
  const ChunkForm form_;
  std::vector<std::unique_ptr<OpenShard>> shards_;
};

// The y and z extents of a band of x extent `width`: as many rows of chunks as fit, filling y
// first so that chunks come in C order. At least one.
Index3 band_size(const StoreLayout& layout, std::int64_t width, std::uint64_t band_bytes) {
  const std::int64_t chunk = layout.parameters.chunk, chunks = layout.chunks();
  const auto row = static_cast<std::uint64_t>(width * chunk * chunk) * sample_bytes(layout.type);
  const auto rows = static_cast<std::int64_t>(
      std::clamp<std::uint64_t>(band_bytes / row, 1, static_cast<std::uint64_t>(chunks * chunks)));
  const std::int64_t deep = std::max<std::int64_t>(1, rows / chunks);
  return {width, (rows < chunks ? rows : chunks) * chunk, deep * chunk};
}

void RunWriter::write(Index3 first, std::span<const Hash128> keys) {
  statistics_.take();  // what another shard's failure may have left
  for (std::size_t i = 0; i < keys.size(); ++i)
    shards_.push_back(std::make_unique<OpenShard>(
        layout_, first + Index3{static_cast<std::int64_t>(i), 0, 0}, keys[i]));
  const Box3 all = {shards_.front()->samples().lo, shards_.back()->samples().hi};
  const Index3 step = band_size(layout_, all.size().x, scratch_.band_bytes);
  for (std::int64_t z = all.lo.z; z < all.hi.z; z += step.z)
    for (std::int64_t y = all.lo.y; y < all.hi.y; y += step.y)
      write_band(intersect({{all.lo.x, y, z}, {all.hi.x, y + step.y, z + step.z}}, all));
  if (shards_.size() == 1) shards_.front()->add_histogram(statistics_.take());
  for (const auto& shard : shards_) shard->commit(scratch_.index);
}

void RunWriter::write_band(const Box3& band) {
  scratch_.band.resize(static_cast<std::size_t>(band.count()) * form_.sample_bytes);
  source_.read(band, scratch_.band.data());
  const std::int64_t side = layout_.parameters.chunk;
  for (const auto& shard : shards_) {
    const Box3 part = intersect(shard->samples(), band);
    each_index(pieces_of(part, splat(side)),
               [&](Index3 chunk) { write_chunk(*shard, chunk, band); });
    // Alone, a shard takes its histogram once, at the end.
    if (shards_.size() > 1) shard->add_histogram(statistics_.take());
  }
}

void RunWriter::write_chunk(OpenShard& shard, Index3 chunk, const Box3& band) {
  const std::int64_t side = layout_.parameters.chunk;
  const Box3 cube = {chunk * side, (chunk + splat(1)) * side};
  const Box3 inside = intersect(cube, {{}, layout_.geometry.size});
  scratch_.chunk.resize(form_.bytes);
  if (inside != cube) std::fill(scratch_.chunk.begin(), scratch_.chunk.end(), std::byte{0});
  shard.note_range(chunk, gather(inside, band));
  const auto& bytes = scratch_.chunk;
  // Comparing the bytes, not the values: -0.0 is not the fill value.
  if (bytes[0] == std::byte{0} &&
      std::memcmp(bytes.data(), bytes.data() + 1, bytes.size() - 1) == 0)
    return;
  encode_chunk(zarr_.codecs, form_, bytes, scratch_.encoded);
  shard.append_chunk(chunk, scratch_.encoded);
}

// Copies the samples of `box` from the band into the chunk buffer, where rows are a chunk long.
ValueRange RunWriter::gather(const Box3& box, const Box3& band) {
  const auto each = static_cast<std::int64_t>(form_.sample_bytes);
  const std::int64_t side = layout_.parameters.chunk;
  const Index3 size = box.size(), pitch = band.size();
  const auto row_bytes = static_cast<std::size_t>(size.x * each);
  const bool whole = size == splat(side);
  ValueRange range;
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      const Index3 at = box.lo + Index3{0, y, z} - band.lo;
      const std::byte* from =
          scratch_.band.data() + ((at.z * pitch.y + at.y) * pitch.x + at.x) * each;
      std::byte* to = scratch_.chunk.data() + (z * side + y) * side * each;
      std::memcpy(to, from, row_bytes);
      if (!whole) range = merge(range, statistics_.add({to, row_bytes}));
    }
  return whole ? statistics_.add(scratch_.chunk) : range;
}

void check_request(const StoreLayout& layout, Index3 first, std::span<const Hash128> keys,
                   const SampleSource& source) {
  const VolumeInfo& info = source.info();
  const Index3 size = layout.geometry.size;
  if (info.geometry.size != size || info.type != layout.type)
    throw InputError(fmt::format(
        "{}: the brick store is of {} x {} x {} {} samples, the volume of {} x {} x {} {}",
        layout.array.string(), size.x, size.y, size.z, sample_type_name(layout.type),
        info.geometry.size.x, info.geometry.size.y, info.geometry.size.z,
        sample_type_name(info.type)));
  const Index3 last = first + Index3{static_cast<std::int64_t>(keys.size()) - 1, 0, 0};
  const Box3 grid = {{}, layout.shard_grid()};
  if (keys.empty() || !grid.contains(first) || !grid.contains(last))
    throw InputError(fmt::format("{}: shards ({} .. {}, {}, {}) are outside the grid {} x {} x {}",
                                 layout.array.string(), first.x, last.x, first.y, first.z,
                                 grid.hi.x, grid.hi.y, grid.hi.z));
}

}  // namespace

std::uint64_t shard_writer_bytes(const StoreLayout& layout, std::int64_t shards,
                                 std::uint64_t band_bytes) {
  const ZarrArray zarr = layout.zarr();
  const std::int64_t width = std::min(shards * layout.parameters.shard, layout.geometry.size.x);
  const Index3 row = band_size(layout, width, 0);
  const auto row_bytes =
      static_cast<std::uint64_t>(row.x * row.y * row.z) * sample_bytes(layout.type);
  const std::uint64_t entries = zarr.index_bytes(0) / 16;
  // A shard in flight: its index twice (entries, bytes), a range an entry, its histogram while it
  // is added to and while it is written.
  const std::uint64_t open = open_file_bytes +
                             entries * (2 * sizeof(ShardIndexEntry) + sizeof(ValueRange)) +
                             3 * sizeof(HistogramBin) * histogram_bins(layout.type);
  return std::max(band_bytes, row_bytes) + zarr.form().bytes +
         largest_encoded_chunk(zarr.codecs, zarr.form()) +
         static_cast<std::uint64_t>(shards) * open;
}

void write_shard(const StoreLayout& layout, Index3 shard, Hash128 key, const SampleSource& source,
                 SampleStatistics& statistics, ShardScratch& scratch) {
  write_shard_row(layout, shard, {&key, 1}, source, statistics, scratch);
}

void write_shard_row(const StoreLayout& layout, Index3 first, std::span<const Hash128> keys,
                     const SampleSource& source, SampleStatistics& statistics,
                     ShardScratch& scratch) {
  check_request(layout, first, keys, source);
  RunWriter(layout, source, statistics, scratch).write(first, keys);
}

}  // namespace voxweld
