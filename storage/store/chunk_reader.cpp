#include "storage/store/chunk_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/store/chunk_reader_detail.h"
#include "storage/support/error.h"
#include "storage/support/small_float.h"

namespace voxweld {
namespace {

Index3 multiply(Index3 a, Index3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

// Chunks kept for each thread: those that a row of bricks has a part in (4 bricks of 64 cells with
// what they need around them), which the next row has in common with it. Less would be given up
// before it is asked for again.
std::size_t chunks_to_keep(const ZarrArray& array, Ownership ownership) {
  constexpr std::uint64_t few_chunks = 8, most_bytes = std::uint64_t{64} << 20;
  constexpr Index3 row{4 * 64 + 4, 64 + 4, 64 + 4};
  if (ownership == Ownership::ours) return 0;
  std::uint64_t chunks = 1;
  const Index3 side = array.axes_of(array.chunk);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t all = (array.size[axis] + side[axis] - 1) / side[axis];
    chunks *= static_cast<std::uint64_t>(std::min(all, (row[axis] - 2) / side[axis] + 2));
  }
  const std::uint64_t fit = most_bytes / std::max<std::uint64_t>(1, decoded_bytes(array));
  return static_cast<std::size_t>(chunks <= fit ? chunks : std::min(few_chunks, fit));
}

// 16-bit floats to those of 32 bits, in place.
void widen(std::vector<std::byte>& samples) {
  const std::size_t count = samples.size() / 2;
  samples.resize(count * sizeof(float));
  for (std::size_t i = count; i-- > 0;) {  // from the end: the wide ones overwrite what is done
    std::uint16_t half = 0;
    std::memcpy(&half, samples.data() + i * sizeof half, sizeof half);
    const float value = float_of_half(half);
    std::memcpy(samples.data() + i * sizeof value, &value, sizeof value);
  }
}

}  // namespace

std::uint64_t decoded_bytes(const ZarrArray& array) {
  return array.form().bytes / array.stored_bytes() * sample_bytes(array.type);
}

ChunkReader::ChunkReader(ZarrArray array, StoreFolder folder, Ownership ownership)
    : array_(std::move(array)),
      folder_(std::move(folder)),
      ownership_(ownership),
      cached_pieces_(pieces_to_cache(array_, folder_.object_memory())),
      kept_chunks_(chunks_to_keep(array_, ownership)) {
  for (std::size_t level = 0; level < array_.shards.size(); ++level)
    pieces_.push_back(std::make_unique<BoundedCache<Piece>>(cached_pieces_));
}

ChunkReader::~ChunkReader() = default;

std::uint64_t ChunkReader::largest_decode() const {
  const ChunkForm form = array_.form();
  const bool inner = array_.codecs.checksums_inside > 0;
  const bool dictionary =
      array_.codecs.compressor && array_.codecs.compressor->kind == CompressorKind::xz;
  std::uint64_t bytes = decoded_bytes(array_) * (1 + kept_chunks_) +
                        largest_encoded_chunk(array_.codecs, form) + folder_.object_memory();
  if (inner) bytes += form.bytes + 64;
  if (dictionary) bytes += form.bytes + (std::uint64_t{1} << 20);
  for (std::size_t level = 0; level < array_.shards.size(); ++level)
    bytes += cached_pieces_ * array_.index_bytes(level);
  if (!array_.shards.empty()) bytes += cached_pieces_ * folder_.object_memory();
  return bytes;
}

void ChunkReader::damaged(const std::string& path, const std::string& what) const {
  if (ownership_ == Ownership::ours)
    throw DamagedArtifact(path, what + "; ingest this shard again");
  throw FormatError(path + ": " + what);
}

void ChunkReader::read(const Box3& box, std::byte* out) const {
  auto buffers = borrow_buffers();
  const Target target{box, out};
  each_index(pieces_of(box, array_.axes_of(array_.file)), [&](Index3 at) {
    if (array_.shards.empty()) {
      read_whole_file(at, target, *buffers);
      return;
    }
    const auto piece = open_piece(0, at, {});
    if (piece->bytes.object)
      read_piece(0, *piece, target, *buffers);
    else
      fill(intersect(box_of(array_.file, at), target.box), target);
  });
  give_back(std::move(buffers));
}

void ChunkReader::each_file(const Box3& box,
                            const std::function<void(const std::filesystem::path&)>& f) const {
  each_index(pieces_of(box, array_.axes_of(array_.file)), [&](Index3 at) {
    if (const auto file = folder_.file_of(array_.file_key(at))) f(*file);
  });
}

void ChunkReader::read_piece(std::size_t level, const Piece& piece, const Target& target,
                             Buffers& buffers) const {
  const Extents& extents = array_.piece(level + 1);
  const Box3 part = intersect(target.box, box_of(array_.piece(level), piece.at));
  each_index(pieces_of(part, array_.axes_of(extents)), [&](Index3 at) {
    const auto locate = [&] { return Encoded{piece.bytes.object, find(level, piece, at)}; };
    if (level + 1 == array_.shards.size()) {
      read_chunk(at, locate, target, buffers);
      return;
    }
    if (const Encoded bytes = locate(); bytes.range.offset != ShardIndexEntry::missing)
      read_piece(level + 1, *open_piece(level + 1, at, bytes), target, buffers);
    else
      fill(intersect(box_of(extents, at), target.box), target);
  });
}

// A file that is one chunk.
void ChunkReader::read_whole_file(Index3 at, const Target& target, Buffers& buffers) const {
  const auto locate = [&] {
    Encoded bytes{open_object(at), {}};
    if (bytes.object) bytes.range = {0, bytes.object->size()};
    return bytes;
  };
  read_chunk(at, locate, target, buffers);
}

// locate() says where the bytes lie, and is asked where the chunk is not kept.
template <class Locate>
void ChunkReader::read_chunk(Index3 at, const Locate& locate, const Target& target,
                             Buffers& buffers) const {
  const auto load = [&](DecodedChunk& chunk) {
    const Encoded bytes = locate();
    chunk.missing = bytes.range.offset == ShardIndexEntry::missing;
    if (!chunk.missing) decode(at, bytes, chunk, buffers);
  };
  const auto use = [&](const DecodedChunk& chunk) {
    if (chunk.missing)
      fill(intersect(box_of(array_.chunk, at), target.box), target);
    else
      copy_chunk(at, chunk, target);
  };
  if (kept_chunks_ == 0) {
    load(buffers.chunk);
    use(buffers.chunk);
    return;
  }
  use(*chunks_.get(grid_key(array_.chunk, at), kept_chunks_ * readers_, load));
}

void ChunkReader::decode(Index3 at, const Encoded& bytes, DecodedChunk& chunk,
                         Buffers& buffers) const {
  const StoredObject& object = *bytes.object;
  const std::uint64_t length = bytes.range.length;
  const std::uint64_t most =
      largest_encoded_chunk(array_.codecs, array_.form()) + block_header_bytes(array_);
  if (length > most)
    damaged(object.name(),
            fmt::format("its chunk has {} bytes, at most {} expected", length, most));
  if (array_.form().bytes / best_chunk_ratio > length)
    damaged(object.name(), fmt::format("its chunk has {} bytes, too few for the {} it decodes to",
                                       length, array_.form().bytes));
  ++decoded_;
  buffers.encoded.resize(length);
  read_bytes(object, bytes.range.offset, buffers.encoded);
  chunk.shape = array_.chunk;
  std::span<const std::byte> encoded = buffers.encoded;
  if (array_.n5_blocks) encoded = take_block_header(object, at, encoded, chunk);
  ChunkForm form{array_.stored_bytes(), array_.stored_bytes()};
  for (const std::int64_t extent : chunk.shape) form.bytes *= static_cast<std::size_t>(extent);
  chunk.samples.resize(form.bytes);
  const std::string wrong =
      decode_chunk(array_.codecs, form, encoded, chunk.samples, buffers.scratch);
  if (!wrong.empty())
    damaged(object.name(),
            fmt::format("chunk (z {}, y {}, x {}) is damaged: {}", at.z, at.y, at.x, wrong));
  if (array_.half) widen(chunk.samples);
}

// f(first sample, where it goes) of each row of the part.
template <class F>
void ChunkReader::each_row(const Box3& part, const Target& target, const F& f) const {
  const auto each = static_cast<std::int64_t>(sample_bytes(array_.type));
  const Index3 size = target.box.size();
  for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
    for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
      const Index3 at{part.lo.x, y, z}, to = at - target.box.lo;
      f(at, target.out + ((to.z * size.y + to.y) * size.x + to.x) * each);
    }
}

void ChunkReader::copy_chunk(Index3 at, const DecodedChunk& chunk, const Target& target) const {
  const std::size_t each = sample_bytes(array_.type);
  const Box3 whole = box_of(array_.chunk, at), part = intersect(whole, target.box);
  Index3 stride;
  std::int64_t next = static_cast<std::int64_t>(each), first = 0;
  for (const int dimension : array_.order) {
    const auto d = static_cast<std::size_t>(dimension);
    if (array_.axes[d] >= 0)
      stride[array_.axes[d]] = next;
    else
      first += array_.at[d] % array_.chunk[d] * next;
    next *= chunk.shape[d];
  }
  const std::int64_t count = part.size().x;
  each_row(part, target, [&](Index3 sample, std::byte* out) {
    const Index3 from = sample - whole.lo;
    const std::byte* in =
        chunk.samples.data() + first + from.z * stride.z + from.y * stride.y + from.x * stride.x;
    if (stride.x == static_cast<std::int64_t>(each)) {
      std::memcpy(out, in, static_cast<std::size_t>(count) * each);
      return;
    }
    for (std::int64_t i = 0; i < count; ++i, in += stride.x, out += each)
      std::memcpy(out, in, each);
  });
}

void ChunkReader::fill(const Box3& part, const Target& target) const {
  const std::size_t each = sample_bytes(array_.type);
  const auto row = static_cast<std::size_t>(part.size().x) * each;
  each_row(part, target, [&](Index3, std::byte* out) {
    for (std::size_t at = 0; at < row; at += each) std::memcpy(out + at, array_.fill.data(), each);
  });
}

Box3 ChunkReader::box_of(const Extents& extents, Index3 at) const {
  const Index3 side = array_.axes_of(extents), lo = multiply(at, side);
  return {lo, lo + side};
}

std::uint64_t ChunkReader::grid_key(const Extents& extents, Index3 at) const {
  const Index3 side = array_.axes_of(extents), grid = divide(array_.size + side - splat(1), side);
  return static_cast<std::uint64_t>((at.z * grid.y + at.y) * grid.x + at.x);
}

std::unique_ptr<ChunkReader::Buffers> ChunkReader::borrow_buffers() const {
  const std::scoped_lock lock(pool_mutex_);
  if (pool_.empty()) {
    ++readers_;
    return std::make_unique<Buffers>();
  }
  auto buffers = std::move(pool_.back());
  pool_.pop_back();
  return buffers;
}

void ChunkReader::give_back(std::unique_ptr<Buffers> buffers) const {
  const std::scoped_lock lock(pool_mutex_);
  pool_.push_back(std::move(buffers));
}

}  // namespace voxweld
