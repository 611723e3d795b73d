#include "storage/hdf5/dataset_blocks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "storage/hdf5/chunk_filters.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::int64_t own_block = 64;  // samples a side, of datasets without chunks
// Deflate makes at most this many bytes of one, and the others that say no size of theirs fewer.
constexpr std::uint64_t best_ratio = 1032;

bool is_ratio_bound(const std::vector<StoredFilter>& filters) {
  return std::ranges::all_of(filters, [](const StoredFilter& filter) {
    return filter.number == 1 || filter.number == 2 || filter.number == 3 || filter.number == 32000;
  });
}

std::vector<hsize_t> as_sizes(const std::vector<std::int64_t>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

DatasetBlocks::DatasetBlocks(std::shared_ptr<const Hdf5File> file, FoundVolume& found)
    : file_(std::move(file)), dataset_(std::move(found.dataset)), facts_(found.facts) {
  const Hdf5Lock lock;
  const SampleType type = *facts_.type.type;
  width_ = sample_bytes(type);
  memory_ = memory_type(dataset_.get(), type);
  fill_ = fill_sample(dataset_.get(), memory_.get(), width_);
  by_library_ = facts_.storage != StorageKind::chunked || !facts_.type.plain ||
                !decodes_chunks(facts_.filters);
  block_ = facts_.chunk;
  if (facts_.storage != StorageKind::chunked) {
    block_.assign(facts_.dims.size(), 1);
    for (const int d : found.place.dimension)
      if (d >= 0) {
        const auto side = static_cast<std::size_t>(d);
        block_[side] = std::min(own_block, facts_.dims[side]);
      }
  }
  block_bytes_ = width_;
  for (const std::int64_t side : block_) block_bytes_ *= static_cast<std::uint64_t>(side);
  if (facts_.storage == StorageKind::chunked) count_chunks();
}

DatasetBlocks::~DatasetBlocks() = default;

void DatasetBlocks::count_chunks() {
  count_ = 1;
  for (std::size_t d = 0; d < block_.size(); ++d)
    count_ *= static_cast<std::uint64_t>((facts_.dims[d] + block_[d] - 1) / block_[d]);
  hsize_t stored = 0;
  const Hdf5Handle space(H5Dget_space(dataset_.get()), H5Sclose);
  if (H5Dget_num_chunks(dataset_.get(), space.get(), &stored) < 0)
    fail_hdf5(file_->where("dataset", facts_.path), "the index of its chunks cannot be read");
  stored_ = stored;
}

std::uint64_t DatasetBlocks::scratch_bytes() const {
  // What libhdf5 holds: a chunk as stored and as decoded, and what it converts. We: the chunk as
  // stored, and one between two filters.
  return (by_library_ ? 3 : 2) * block_bytes_ + (std::uint64_t{1} << 20);
}

std::string DatasetBlocks::where(const std::vector<std::int64_t>& first) const {
  return fmt::format("{}: the chunk at ({})", file_->where("dataset", facts_.path),
                     fmt::join(first, ", "));
}

// Bytes of the chunk in the file; 0 where none is stored.
std::uint64_t DatasetBlocks::stored_bytes(const std::vector<std::int64_t>& first) const {
  const std::vector<hsize_t> at = as_sizes(first);
  hsize_t bytes = 0;
  if (stored_ == 0) return 0;
  if (H5Dget_chunk_storage_size(dataset_.get(), at.data(), &bytes) >= 0) return bytes;
  // A chunk that was never written is an error to some versions. The other question takes the
  // longer the more chunks there are, so it comes second.
  const std::string reason = hdf5_reason();
  if (reason == "chunk storage is not allocated") return 0;
  unsigned mask = 0;
  haddr_t place = HADDR_UNDEF;
  if (H5Dget_chunk_info_by_coord(dataset_.get(), at.data(), &mask, &place, &bytes) >= 0 &&
      place == HADDR_UNDEF)
    return 0;
  throw FormatError(fmt::format("{}: its place cannot be read: {}", where(first), reason));
}

// Empty where no such chunk is stored.
DatasetBlocks::StoredChunk DatasetBlocks::read_stored(
    const std::vector<std::int64_t>& first) const {
  const Hdf5Lock lock;
  const std::vector<hsize_t> at = as_sizes(first);
  StoredChunk chunk;
  const std::uint64_t bytes = stored_bytes(first);
  if (bytes == 0) return chunk;
  const std::uint64_t most = 2 * block_bytes_ + 65536;
  if (bytes > facts_.holder_bytes || bytes > most)
    throw FormatError(fmt::format(
        "{}: its stored size is {} bytes, where {} hold it and the file has {}: get a sound copy",
        where(first), bytes, most, facts_.holder_bytes));
  if (is_ratio_bound(facts_.filters) && block_bytes_ / best_ratio > bytes)
    throw FormatError(fmt::format("{}: {} stored bytes cannot hold its {} bytes: get a sound copy",
                                  where(first), bytes, block_bytes_));
  chunk.bytes.resize(static_cast<std::size_t>(bytes));
  if (H5Dread_chunk(dataset_.get(), H5P_DEFAULT, at.data(), &chunk.mask, chunk.bytes.data()) < 0)
    fail_hdf5(where(first), "it cannot be read");
  return chunk;
}

std::unique_ptr<std::byte[]> DatasetBlocks::load_by_library(
    const std::vector<std::int64_t>& first) const {
  const Hdf5Lock lock;
  std::vector<std::int64_t> size = block_;
  for (std::size_t d = 0; d < size.size(); ++d)
    size[d] = std::min(size[d], facts_.dims[d] - first[d]);
  const Hdf5Handle stored(H5Dget_space(dataset_.get()), H5Sclose);
  const auto rank = static_cast<int>(block_.size());
  const Hdf5Handle whole(H5Screate_simple(rank, as_sizes(block_).data(), nullptr), H5Sclose);
  const std::vector<hsize_t> origin(block_.size(), 0);
  if (H5Sselect_hyperslab(stored.get(), H5S_SELECT_SET, as_sizes(first).data(), nullptr,
                          as_sizes(size).data(), nullptr) < 0 ||
      H5Sselect_hyperslab(whole.get(), H5S_SELECT_SET, origin.data(), nullptr,
                          as_sizes(size).data(), nullptr) < 0)
    fail_hdf5(where(first), "it cannot be read");
  auto samples = std::make_unique_for_overwrite<std::byte[]>(block_bytes_);
  if (H5Dread(dataset_.get(), memory_.get(), whole.get(), stored.get(), H5P_DEFAULT,
              samples.get()) < 0)
    fail_hdf5(where(first), "it cannot be read");
  return samples;
}

std::unique_ptr<std::byte[]> DatasetBlocks::load(const std::vector<std::int64_t>& first) const {
  if (by_library_) return load_by_library(first);
  const StoredChunk chunk = read_stored(first);
  if (chunk.bytes.empty()) return nullptr;
  auto samples = std::make_unique_for_overwrite<std::byte[]>(block_bytes_);
  const std::span out(samples.get(), static_cast<std::size_t>(block_bytes_));
  if (const auto wrong = decode_stored_chunk(facts_.filters, chunk.mask, chunk.bytes, out);
      !wrong.empty())
    throw FormatError(fmt::format("{}: damaged: {}: get a sound copy", where(first), wrong));
  to_native(samples.get(), out.size() / width_, width_, facts_.type.order);
  return samples;
}

}  // namespace voxweld
