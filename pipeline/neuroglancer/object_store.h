// Where the objects of the multi-resolution format go: files of their own, or shards of many.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace voxweld {

// Bits of an object's id choose where it lies, from the lowest: the minishard, then the shard.
struct Sharding {
  int minishard_bits = 0, shard_bits = 0;

  std::uint64_t minishard(std::uint64_t id) const {
    return id & ((std::uint64_t{1} << minishard_bits) - 1);
  }
  std::uint64_t shard(std::uint64_t id) const {
    return id >> minishard_bits & ((std::uint64_t{1} << shard_bits) - 1);
  }
};
// For so many objects.
Sharding sharding_for(std::uint64_t objects);
// The order in which a store takes them.
std::vector<std::size_t> order_in_shards(std::span<const std::uint64_t> ids, Sharding sharding);

// Takes objects one after the other: the bytes of an object's fragments, and then its manifest.
class ObjectStore {
 public:
  virtual ~ObjectStore() = default;
  virtual void append(std::uint64_t id, std::span<const std::byte> fragment) = 0;
  virtual void finish(std::uint64_t id, std::span<const std::byte> manifest) = 0;
  virtual void close() = 0;  // after the last object
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t files() const { return files_; }

 protected:
  std::uint64_t bytes_ = 0, files_ = 0;
};

// `<id>` and `<id>.index` in that folder.
std::unique_ptr<ObjectStore> file_store(const std::filesystem::path& folder);
// `<shard>.shard`. Objects are to come in the order of order_in_shards.
std::unique_ptr<ObjectStore> shard_store(const std::filesystem::path& folder, Sharding sharding);

}  // namespace voxweld
