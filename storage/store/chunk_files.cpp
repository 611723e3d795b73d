#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/store/chunk_reader_detail.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Open files are file descriptors too, so a few of them; large indexes are kept fewer.
constexpr std::uint64_t most_cached_files = 32;
constexpr std::uint64_t most_cached_bytes = std::uint64_t{16} << 20;

std::uint32_t big_endian_at(std::span<const std::byte> bytes, std::size_t at, std::size_t width) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < width; ++i)
    value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

}  // namespace

std::size_t pieces_to_cache(const ZarrArray& array, std::uint64_t object_memory) {
  std::uint64_t largest = std::max<std::uint64_t>(1, object_memory);
  for (std::size_t level = 0; level < array.shards.size(); ++level)
    largest = std::max(largest, array.index_bytes(level));
  return static_cast<std::size_t>(
      std::clamp<std::uint64_t>(most_cached_bytes / largest, 1, most_cached_files));
}

void ChunkReader::read_bytes(const StoredObject& object, std::uint64_t offset,
                             std::span<std::byte> out) const {
  try {
    object.read(offset, out);
  } catch (const FormatError&) {
    if (ownership_ == Ownership::theirs) throw;
    damaged(object.name(),  // cut while it was open
            fmt::format("truncated: it ends before byte {}", offset + out.size()));
  }
}

// Null where the file is missing.
std::shared_ptr<const StoredObject> ChunkReader::open_object(Index3 at) const {
  const std::string key = array_.file_key(at);
  std::shared_ptr<const StoredObject> object =
      folder_.open(key, array_.shards.empty() ? ObjectUse::whole : ObjectUse::ranges);
  if (!object && ownership_ == Ownership::ours) damaged((folder_ / key).name(), "missing");
  return object;
}

// Of level 0 the file is opened; of others the bytes are given.
std::shared_ptr<const ChunkReader::Piece> ChunkReader::open_piece(std::size_t level, Index3 at,
                                                                  const Encoded& bytes) const {
  return pieces_[level]->get(grid_key(array_.piece(level), at), [&] {
    auto piece = std::make_shared<Piece>();
    piece->at = at;
    piece->bytes = bytes;
    if (level == 0) {
      piece->bytes.object = open_object(at);
      if (piece->bytes.object) piece->bytes.range = {0, piece->bytes.object->size()};
    }
    if (piece->bytes.object) load_index(level, *piece);
    return piece;
  });
}

void ChunkReader::load_index(std::size_t level, Piece& piece) const {
  const StoredObject& object = *piece.bytes.object;
  const auto [begin, size] = piece.bytes.range;
  const ShardIndexForm& form = array_.shards[level].index;
  const std::uint64_t bytes = array_.index_bytes(level);
  if (size < bytes)
    damaged(object.name(),
            fmt::format("truncated: its index alone takes {} bytes, {} found", bytes, size));
  std::vector<std::byte> buffer(bytes);
  read_bytes(object, form.at_end ? begin + size - bytes : begin, buffer);
  std::span<const std::byte> entries = buffer;
  for (int i = 0; i < form.checksums; ++i)
    if (const std::string wrong = strip_checksum(entries); !wrong.empty())
      damaged(object.name(), "its index is damaged: " + wrong);
  if (form.big_endian) to_native(buffer.data(), entries.size() / 8, 8, std::endian::big);
  piece.index.resize(entries.size() / sizeof(ShardIndexEntry));
  std::memcpy(piece.index.data(), entries.data(), entries.size());
  const bool innermost = level + 1 == array_.shards.size();
  const std::uint64_t most =
      innermost ? largest_encoded_chunk(array_.codecs, array_.form()) : ShardIndexEntry::missing;
  for (std::size_t i = 0; i < piece.index.size(); ++i) {
    auto& [offset, length] = piece.index[i];
    if (offset == ShardIndexEntry::missing && length == ShardIndexEntry::missing) continue;
    if (length > most || offset > size || length > size - offset)
      damaged(
          object.name(),
          fmt::format("its index puts chunk {} at {} with {} bytes; the file has {} and a chunk "
                      "at most {}",
                      i, offset, length, size, most));
    offset += begin;
  }
}

// inner: in the grid of the level below.
ShardIndexEntry ChunkReader::find(std::size_t level, const Piece& piece, Index3 inner) const {
  const Extents &outer = array_.piece(level), &each = array_.piece(level + 1);
  std::size_t entry = 0;
  for (const int dimension : array_.shards[level].order) {
    const auto d = static_cast<std::size_t>(dimension);
    const std::int64_t count = outer[d] / each[d];
    const int axis = array_.axes[d];
    const std::int64_t at =
        axis >= 0 ? inner[axis] - piece.at[axis] * count : array_.at[d] % outer[d] / each[d];
    entry = entry * static_cast<std::size_t>(count) + static_cast<std::size_t>(at);
  }
  return piece.index[entry];
}

// N5: mode u16, dimensions u16, extents u32 of each, the fastest first, and of mode 1 the count of
// elements u32; big-endian. The blocks at the upper borders may be cut short.
constexpr std::size_t n5_fixed_bytes = 4, n5_extent_bytes = 4;

std::uint64_t block_header_bytes(const ZarrArray& array) {
  return array.n5_blocks ? n5_fixed_bytes + n5_extent_bytes * (array.axes.size() + 1) : 0;
}

std::span<const std::byte> ChunkReader::take_block_header(const StoredObject& object, Index3 at,
                                                          std::span<const std::byte> bytes,
                                                          DecodedChunk& chunk) const {
  const std::size_t rank = array_.axes.size();
  std::size_t header = n5_fixed_bytes + n5_extent_bytes * rank;
  if (bytes.size() < header)
    damaged(object.name(), fmt::format("truncated: {} bytes, and its header alone takes {}",
                                       bytes.size(), header));
  const std::uint32_t mode = big_endian_at(bytes, 0, 2), said = big_endian_at(bytes, 2, 2);
  if (mode > 1)
    damaged(object.name(), fmt::format("a block of mode {}, which is not supported: 0 is", mode));
  if (said != rank)
    damaged(object.name(), fmt::format("a block of {} dimensions, {} expected", said, rank));
  std::uint64_t count = 1;
  for (std::size_t d = 0; d < rank; ++d) {
    const auto extent = static_cast<std::int64_t>(
        big_endian_at(bytes, n5_fixed_bytes + n5_extent_bytes * (rank - 1 - d), n5_extent_bytes));
    const int axis = array_.axes[d];
    // As far as the array goes it must hold samples.
    const std::int64_t needed =
        axis < 0 ? array_.at[d] % array_.chunk[d] + 1
                 : std::min(array_.chunk[d], array_.size[axis] - at[axis] * array_.chunk[d]);
    if (extent < needed || extent > array_.chunk[d])
      damaged(object.name(), fmt::format("its block is {} samples long in dimension {}, {} to {} "
                                         "expected",
                                         extent, rank - 1 - d, needed, array_.chunk[d]));
    chunk.shape[d] = extent;
    count *= static_cast<std::uint64_t>(extent);
  }
  if (mode == 0) return bytes.subspan(header);
  if (bytes.size() < header + n5_extent_bytes) damaged(object.name(), "truncated in its header");
  if (const std::uint32_t elements = big_endian_at(bytes, header, n5_extent_bytes);
      elements != count)
    damaged(object.name(), fmt::format("its block has {} elements for {} samples: blocks of "
                                       "another length are not supported",
                                       elements, count));
  return bytes.subspan(header + n5_extent_bytes);
}

}  // namespace voxweld
