#include "storage/store/chunk_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Open files are file descriptors too, so a few of them; large indexes are kept fewer.
constexpr std::uint64_t most_cached_files = 32;
constexpr std::uint64_t most_cached_bytes = std::uint64_t{16} << 20;

// More than any codec makes of one byte: what says it is larger is not worth its memory.
constexpr std::uint64_t best_chunk_ratio = std::uint64_t{1} << 17;

std::size_t cached_files(const ZarrArray& array) {
  return array.sharded ? static_cast<std::size_t>(std::clamp<std::uint64_t>(
                             most_cached_bytes / array.index_bytes(), 1, most_cached_files))
                       : 1;
}

Index3 multiply(Index3 a, Index3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

}  // namespace

struct ChunkReader::Shard {
  std::optional<ReadFile> file;        // none where the file is missing
  Index3 at;                           // in the grid of files
  std::vector<ShardIndexEntry> index;  // sharded arrays only
};

struct ChunkReader::Buffers {
  std::vector<std::byte> encoded, chunk, scratch;
};

ChunkReader::ChunkReader(ZarrArray array, Ownership ownership)
    : array_(std::move(array)),
      ownership_(ownership),
      cached_files_(cached_files(array_)),
      files_(cached_files_) {}

ChunkReader::~ChunkReader() = default;

std::uint64_t ChunkReader::largest_decode() const {
  const ChunkForm form = array_.form();
  const std::uint64_t scratch = array_.codecs.checksums_inside > 0 ? form.bytes + 64 : 0;
  const std::uint64_t indexes = array_.sharded ? cached_files_ * array_.index_bytes() : 0;
  return form.bytes + largest_encoded_chunk(array_.codecs, form) + scratch + indexes;
}

void ChunkReader::damaged(const std::string& path, const std::string& what) const {
  if (ownership_ == Ownership::ours)
    throw DamagedArtifact(path, what + "; ingest this shard again");
  throw FormatError(path + ": " + what);
}

void ChunkReader::read_bytes(const Shard& shard, std::uint64_t offset,
                             std::span<std::byte> out) const {
  try {
    shard.file->read(offset, out);
  } catch (const FormatError&) {  // cut while it was open
    damaged(shard.file->path(),
            fmt::format("truncated: it ends before byte {}", offset + out.size()));
  }
}

std::shared_ptr<const ChunkReader::Shard> ChunkReader::open_file(Index3 at) const {
  if (!array_.sharded) return load_file(at);  // one chunk: nothing to keep
  const Index3 grid = divide(array_.size + array_.file - splat(1), array_.file);
  const auto key = static_cast<std::uint64_t>((at.z * grid.y + at.y) * grid.x + at.x);
  return files_.get(key, [&] { return load_file(at); });
}

std::shared_ptr<const ChunkReader::Shard> ChunkReader::load_file(Index3 at) const {
  auto shard = std::make_shared<Shard>();
  shard->at = at;
  const std::filesystem::path path = array_.file_path(at);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (error) throw_errno("look up", path.string(), error.value());
    if (ownership_ == Ownership::ours) damaged(path.string(), "missing");
    return shard;
  }
  shard->file.emplace(path);
  if (array_.sharded) load_index(*shard);
  return shard;
}

void ChunkReader::load_index(Shard& shard) const {
  const ReadFile& file = *shard.file;
  const std::uint64_t bytes = array_.index_bytes();
  if (file.size() < bytes)
    damaged(file.path(),
            fmt::format("truncated: its index alone takes {} bytes, {} found", bytes, file.size()));
  std::vector<std::byte> buffer(bytes);
  read_bytes(shard, array_.index.at_end ? file.size() - bytes : 0, buffer);
  std::span<const std::byte> entries = buffer;
  for (int i = 0; i < array_.index.checksums; ++i)
    if (const std::string wrong = strip_checksum(entries); !wrong.empty())
      damaged(file.path(), "its index is damaged: " + wrong);
  if (array_.index.big_endian) to_native(buffer.data(), entries.size() / 8, 8, std::endian::big);
  shard.index.resize(entries.size() / sizeof(ShardIndexEntry));
  std::memcpy(shard.index.data(), entries.data(), entries.size());
  const std::uint64_t most = largest_encoded_chunk(array_.codecs, array_.form());
  for (std::size_t i = 0; i < shard.index.size(); ++i) {
    const auto [offset, length] = shard.index[i];
    if (offset == ShardIndexEntry::missing && length == ShardIndexEntry::missing) continue;
    if (length > most || offset > file.size() || length > file.size() - offset)
      damaged(
          file.path(),
          fmt::format("its index puts chunk {} at {} with {} bytes; the file has {} and a chunk "
                      "at most {}",
                      i, offset, length, file.size(), most));
  }
}

void ChunkReader::read(const Box3& box, std::byte* out) const {
  auto buffers = borrow_buffers();
  const Target target{box, out};
  each_index(pieces_of(box, array_.file), [&](Index3 at) { read_file(at, target, *buffers); });
  give_back(std::move(buffers));
}

void ChunkReader::each_file(const Box3& box,
                            const std::function<void(const std::filesystem::path&)>& f) const {
  each_index(pieces_of(box, array_.file), [&](Index3 at) { f(array_.file_path(at)); });
}

void ChunkReader::read_file(Index3 at, const Target& target, Buffers& buffers) const {
  const Index3 lo = multiply(at, array_.file);
  const Box3 part = intersect(target.box, {lo, lo + array_.file});
  const auto shard = open_file(at);
  if (!shard->file) {
    fill(part, target);
    return;
  }
  each_index(pieces_of(part, array_.chunk), [&](Index3 chunk) {
    const Index3 chunk_lo = multiply(chunk, array_.chunk);
    const Box3 samples = {chunk_lo, chunk_lo + array_.chunk};
    if (load_chunk(*shard, chunk, buffers))
      copy_chunk(samples, target, buffers);
    else
      fill(intersect(samples, target.box), target);
  });
}

// False where the chunk is missing, which is all fill value.
bool ChunkReader::load_chunk(const Shard& shard, Index3 chunk, Buffers& buffers) const {
  ShardIndexEntry entry{0, shard.file->size()};
  if (array_.sharded) {
    const Index3 grid = array_.chunks_in_file(), in = chunk - multiply(shard.at, grid);
    std::int64_t at = 0;
    for (const int axis : array_.axes) at = at * grid[axis] + in[axis];
    entry = shard.index[static_cast<std::size_t>(at)];
    if (entry.offset == ShardIndexEntry::missing) return false;
  }
  const ChunkForm form = array_.form();
  const std::uint64_t most = largest_encoded_chunk(array_.codecs, form);
  if (entry.length > most)
    damaged(shard.file->path(),
            fmt::format("its chunk has {} bytes, at most {} expected", entry.length, most));
  if (form.bytes / best_chunk_ratio > entry.length)
    damaged(shard.file->path(),
            fmt::format("its chunk has {} bytes, too few for the {} it decodes to", entry.length,
                        form.bytes));
  buffers.encoded.resize(entry.length);
  buffers.chunk.resize(form.bytes);
  read_bytes(shard, entry.offset, buffers.encoded);
  const std::string wrong =
      decode_chunk(array_.codecs, form, buffers.encoded, buffers.chunk, buffers.scratch);
  if (!wrong.empty())
    damaged(shard.file->path(), fmt::format("chunk (z {}, y {}, x {}) is damaged: {}", chunk.z,
                                            chunk.y, chunk.x, wrong));
  return true;
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

void ChunkReader::copy_chunk(const Box3& chunk, const Target& target,
                             const Buffers& buffers) const {
  const std::size_t each = sample_bytes(array_.type);
  const Box3 part = intersect(chunk, target.box);
  const Index3 side = chunk.size();
  Index3 stride;
  std::int64_t next = static_cast<std::int64_t>(each);
  for (const int axis : array_.order) {
    stride[axis] = next;
    next *= side[axis];
  }
  const std::int64_t count = part.size().x;
  each_row(part, target, [&](Index3 at, std::byte* out) {
    const Index3 from = at - chunk.lo;
    const std::byte* in =
        buffers.chunk.data() + from.z * stride.z + from.y * stride.y + from.x * stride.x;
    if (array_.order[0] == 0) {
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

std::unique_ptr<ChunkReader::Buffers> ChunkReader::borrow_buffers() const {
  const std::scoped_lock lock(pool_mutex_);
  if (pool_.empty()) return std::make_unique<Buffers>();
  auto buffers = std::move(pool_.back());
  pool_.pop_back();
  return buffers;
}

void ChunkReader::give_back(std::unique_ptr<Buffers> buffers) const {
  const std::scoped_lock lock(pool_mutex_);
  pool_.push_back(std::move(buffers));
}

}  // namespace voxweld
