// neuroglancer_uint64_sharded_v1, with the identity as hash, and nothing compressed:
//
//     2^minishard_bits pairs of offsets     where the index of each minishard begins and ends
//     fragments, manifest                   of one object after the other
//     ...
//     indices of minishards                 3 n numbers of 64 bits: all ids, all offsets, all sizes
//
// Offsets count from the end of the first part. In an index, ids are differences to the id before, and
// offsets to the end of the manifest before: fragments lie between.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

#include "pipeline/neuroglancer/object_store.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

// An index is read whole to find one object.
constexpr std::uint64_t objects_a_minishard = 64;
constexpr int most_minishard_bits = 9;

class ShardStore : public ObjectStore {
 public:
  ShardStore(std::filesystem::path folder, Sharding sharding)
      : folder_(std::move(folder)), sharding_(sharding) {}

  void append(std::uint64_t id, std::span<const std::byte> fragment) override {
    open(id);
    file_->append(fragment);
  }
  void finish(std::uint64_t id, std::span<const std::byte> manifest) override {
    open(id);
    minishards_[sharding_.minishard(id)].push_back(
        {id, file_->size() - first_part(), manifest.size()});
    file_->append(manifest);
  }
  void close() override {
    if (!file_) return;
    std::vector<std::uint64_t> ends;
    for (const std::vector<Entry>& entries : minishards_) {
      ends.push_back(file_->size() - first_part());
      append_numbers(index_of(entries));
      ends.push_back(file_->size() - first_part());
    }
    // No commit has happened: the numbers fill what was left for them.
    file_->write_at(0, std::as_bytes(std::span(ends)));
    bytes_ += file_->size();
    ++files_;
    file_->commit(Durability::rename_only);
    file_.reset();
  }

 private:
  struct Entry {
    std::uint64_t id = 0, offset = 0, size = 0;
  };

  std::uint64_t first_part() const { return std::uint64_t{16} << sharding_.minishard_bits; }
  void append_numbers(const std::vector<std::uint64_t>& numbers) {
    file_->append(std::as_bytes(std::span(numbers)));
  }
  void open(std::uint64_t id) {
    if (file_ && shard_ != sharding_.shard(id)) close();
    if (file_) return;
    shard_ = sharding_.shard(id);
    const int digits = (sharding_.shard_bits + 3) / 4;
    file_.emplace(folder_ / fmt::format("{:0{}x}.shard", shard_, digits));
    minishards_.assign(std::size_t{1} << sharding_.minishard_bits, {});
    append_numbers(std::vector<std::uint64_t>(2 * minishards_.size()));
  }
  static std::vector<std::uint64_t> index_of(const std::vector<Entry>& entries) {
    std::vector<std::uint64_t> ids, offsets, sizes;
    Entry before;
    for (const Entry& entry : entries) {
      ids.push_back(entry.id - before.id);
      offsets.push_back(entry.offset - (before.offset + before.size));
      sizes.push_back(entry.size);
      before = entry;
    }
    ids.insert(ids.end(), offsets.begin(), offsets.end());
    ids.insert(ids.end(), sizes.begin(), sizes.end());
    return ids;
  }

  std::filesystem::path folder_;
  Sharding sharding_;
  std::optional<AtomicFile> file_;  // of the shard under way
  std::uint64_t shard_ = 0;
  std::vector<std::vector<Entry>> minishards_;
};

}  // namespace

Sharding sharding_for(std::uint64_t objects) {
  const std::uint64_t minishards = (objects + objects_a_minishard - 1) / objects_a_minishard;
  const int bits = minishards <= 1 ? 0 : static_cast<int>(std::bit_width(minishards - 1));
  const int minishard_bits = std::min(bits, most_minishard_bits);
  return {minishard_bits, bits - minishard_bits};
}

std::vector<std::size_t> order_in_shards(std::span<const std::uint64_t> ids, Sharding sharding) {
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) {
    return std::tuple(sharding.shard(ids[i]), sharding.minishard(ids[i]), ids[i]);
  });
  return order;
}

std::unique_ptr<ObjectStore> shard_store(const std::filesystem::path& folder, Sharding sharding) {
  return std::make_unique<ShardStore>(folder, sharding);
}

}  // namespace voxweld
