#include "storage/spool/spool.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <system_error>
#include <utility>

#include "storage/spool/chunk_spool.h"
#include "storage/spool/spool_record.h"
#include "storage/support/error.h"
#include "storage/support/hash_file.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/filters.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Samples that need no decoding are still in the processor's cache when they are written: with bands
// of 32 MiB writing took three times as long. What is decoded in one piece is better read in one.
constexpr std::uint64_t largest_band = std::uint64_t{32} << 20;
constexpr std::uint64_t cached_band = std::uint64_t{512} << 10;

std::uint64_t row_bytes(const VolumeInfo& info) {
  return static_cast<std::uint64_t>(info.geometry.size.x) * sample_bytes(info.type);
}

std::uint64_t slice_bytes(const VolumeInfo& info) {
  return row_bytes(info) * static_cast<std::uint64_t>(info.geometry.size.y);
}

// Rows read at once: whole slices where the source gives nothing less.
std::int64_t band_rows(const VolumeInfo& info, std::uint64_t memory) {
  const std::uint64_t needed = spool_memory_needed(info);
  if (memory < needed)
    throw InputError(fmt::format(
        "spooling {} ({} x {} x {} {}) needs {} bytes of memory, {} are given; raise run.memory",
        info.files.empty() ? info.format : info.files.front().path, info.geometry.size.x,
        info.geometry.size.y, info.geometry.size.z, sample_type_name(info.type), needed, memory));
  if (info.access == Access::stream) return info.geometry.size.y;
  const std::uint64_t band =
      std::min(memory - info.largest_decode, info.largest_decode == 0 ? cached_band : largest_band);
  const std::uint64_t rows = std::max<std::uint64_t>(1, band / row_bytes(info));
  return std::min(info.geometry.size.y, static_cast<std::int64_t>(rows));
}

// Better now than after hours. Says nothing of quotas, so writing is still checked.
void require_space(const fs::path& path, std::uint64_t bytes) {
  if (path.has_parent_path()) make_directories(path.parent_path());
  std::error_code error;
  const fs::space_info space =
      fs::space(path.has_parent_path() ? path.parent_path() : fs::path("."), error);
  if (error || space.available >= bytes) return;
  throw StorageError(fmt::format(
      "cannot write the spool {}: it takes {} bytes, the disk has {} left; free some space or put "
      "the work directory elsewhere",
      path.string(), bytes, space.available));
}

Hash128 write_samples(const SampleSource& source, AtomicFile& file, const SpoolOptions& options) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  const std::int64_t rows = band_rows(info, options.memory);
  std::vector<std::byte> band(row_bytes(info) * static_cast<std::uint64_t>(rows));
  StreamHasher hasher;
  const std::uint64_t total = spool_bytes(info);
  for (std::int64_t z = 0; z < size.z; ++z) {
    for (std::int64_t y = 0; y < size.y; y += rows) {
      if (options.cancel != nullptr && options.cancel->load(std::memory_order_relaxed))
        throw Interrupted();
      const std::int64_t end = std::min(y + rows, size.y);
      source.read({{0, y, z}, {size.x, end, z + 1}}, band.data());
      const auto data =
          std::span(band).first(row_bytes(info) * static_cast<std::uint64_t>(end - y));
      hasher.update(data);
      file.append(data);
      if (options.progress) options.progress({file.size(), total});
    }
  }
  return hasher.finish();
}

std::unique_ptr<SampleSource> open_samples(const fs::path& path, const VolumeInfo& info) {
  VolumeInfo raw;
  raw.format = "raw";
  raw.type = info.type;
  raw.geometry.size = info.geometry.size;
  DataLayout layout;
  layout.parts.push_back({path, 0, 0});
  layout.byte_order = std::endian::native;
  return open_layout(std::move(raw), std::move(layout));
}

struct OpenedSpool {
  ReadFile file;
  SpoolRecord record;
};

OpenedSpool open_checked(const fs::path& path, Hash128 key) {
  SpoolRecord record = read_spool_record(path);
  if (record.key != key)
    throw DamagedArtifact(path.string(), fmt::format("a spool of another input: expected key {}, "
                                                     "found {}; spool the input again",
                                                     to_hex(key), to_hex(record.key)));
  ReadFile file(path);
  if (const std::uint64_t expected = spool_bytes(record.info); file.size() != expected)
    throw DamagedArtifact(
        path.string(), fmt::format("expected {} bytes of samples, found {}; spool the input again",
                                   expected, file.size()));
  return {std::move(file), std::move(record)};
}

}  // namespace

std::uint64_t spool_bytes(const VolumeInfo& info) {
  std::int64_t bytes = static_cast<std::int64_t>(sample_bytes(info.type));
  bool overflow = false;
  for (int axis = 0; axis < 3; ++axis)
    overflow |= __builtin_mul_overflow(bytes, info.geometry.size[axis], &bytes);
  if (overflow || bytes <= 0)
    throw InputError(
        fmt::format("a volume of {} x {} x {} {} samples cannot be spooled: its size "
                    "in bytes does not fit 63 bits",
                    info.geometry.size.x, info.geometry.size.y, info.geometry.size.z,
                    sample_type_name(info.type)));
  return static_cast<std::uint64_t>(bytes);
}

std::uint64_t spool_memory_needed(const VolumeInfo& info) {
  if (info.access == Access::chunks) return chunk_spool_memory(info);
  return info.largest_decode +
         (info.access == Access::stream ? slice_bytes(info) : row_bytes(info));
}

void spool_volume(const SampleSource& source, const fs::path& path, Hash128 key,
                  const SpoolOptions& options) {
  const std::uint64_t bytes = spool_bytes(source.info());
  band_rows(source.info(), options.memory);  // refuse before anything is removed
  remove_file(spool_record_path(path));
  remove_file(path);
  require_space(path, bytes);
  SpoolRecord record;
  record.key = key;
  record.info = source.info();
  AtomicFile file(path);
  const bool chunks = source.info().access == Access::chunks;
  if (chunks)
    write_chunks(source, file, options);
  else
    record.data_hash = write_samples(source, file, options);
  // Boxes are read without checking a hash, so what power loss may do to the data has to be
  // excluded before the record vouches for it.
  file.commit(Durability::fsync);
  // They were written in no order: what the file holds is hashed.
  if (chunks) record.data_hash = hash_file(ReadFile(path));
  write_spool_record(path, record);
}

std::unique_ptr<SampleSource> open_spool(const fs::path& path, Hash128 key) {
  OpenedSpool opened = open_checked(path, key);
  VolumeInfo& info = opened.record.info;
  auto samples = open_samples(path, info);
  info.access = samples->info().access;
  info.largest_decode = samples->info().largest_decode;
  return source_with_info(std::move(samples), std::move(info));
}

void verify_spool(const fs::path& path, Hash128 key) {
  const OpenedSpool opened = open_checked(path, key);
  if (hash_file(opened.file) != opened.record.data_hash)
    throw DamagedArtifact(path.string(),
                          "its samples do not match their hash; spool the input again");
}

}  // namespace voxweld
