// What ClusterReduction takes and leaves (storage/types/node_record.h, top_tree.h) as bytes, for the
// sections of artifacts: of each the figures of its head, then its lists, little-endian. A record
// is at most 2.5 KiB from level 5 on, where nodes are sealed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "storage/types/top_tree.h"

namespace voxweld {

// Appends.
void put_bytes(const NodeRecord& record, std::vector<std::byte>& out);
// All but node.record: who reads that, mostly does not need these.
void put_links(const ReducedNode& node, std::vector<std::byte>& out);

// Takes them back, one after the other. False where the bytes end too early, or say what cannot be:
// whoever holds the file says then that it is damaged. Else every number that names a cluster, a
// curve, a leaf or a link is one of what it counts.
class RecordBytes {
 public:
  explicit RecordBytes(std::span<const std::byte> bytes) : rest_(bytes) {}
  bool empty() const { return rest_.empty(); }
  [[nodiscard]] bool take(NodeRecord& record);
  // Precondition: node.record is that of what was written, since links name its clusters.
  [[nodiscard]] bool take_links(ReducedNode& node);

 private:
  template <class T>
  bool take_one(T& value);
  template <class T>
  bool take_list(std::uint64_t count, std::vector<T>& values);
  bool take_cluster(ClusterRecord& cluster);
  bool take_counts(LeafCounts& counts);

  std::span<const std::byte> rest_;
};

}  // namespace voxweld
