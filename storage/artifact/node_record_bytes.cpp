#include "storage/artifact/node_record_bytes.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace voxweld {
namespace {

struct RecordHead {
  std::uint32_t blocked = 0, closes = 0;
  std::uint64_t clusters = 0, curves = 0, pairs = 0;
};
struct ReducedHead {
  std::uint64_t leaves = 0, nodes = 0, links = 0;
};

// Written as they lie in memory, so none may have padding, whose bytes would be whatever was there
// before. (Those with floats cannot be asked; ClusterRecord has some, and is written by parts.)
static_assert(std::has_unique_object_representations_v<FaceCurve> &&
              std::has_unique_object_representations_v<CurvePair> &&
              std::has_unique_object_representations_v<LinkedNode> &&
              std::has_unique_object_representations_v<ClusterLink> &&
              std::has_unique_object_representations_v<RecordHead> &&
              std::has_unique_object_representations_v<ReducedHead> && sizeof(Qef) == 60 &&
              sizeof(NormalClusters) == 40 && sizeof(ClusterLeaf) == 48);

template <class T>
void put_one(const T& value, std::vector<std::byte>& out) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof(T));
}
template <class T>
void put_list(const std::vector<T>& values, std::vector<std::byte>& out) {
  for (const T& value : values) put_one(value, out);
}

// Of the levels that have any: a brick's clusters have few of all levels there are.
void put_counts(const LeafCounts& counts, std::vector<std::byte>& out) {
  const std::size_t levels = counts.levels();
  put_one(static_cast<std::uint64_t>(levels), out);
  for (std::size_t l = 0; l < levels; ++l) {
    put_one(counts.leaves[l], out);
    put_one(counts.errors[l], out);
  }
}

void put_cluster(const ClusterRecord& cluster, std::vector<std::byte>& out) {
  put_one(cluster.qef, out);
  put_one(cluster.normals, out);
  put_one(cluster.offset, out);
  put_one(cluster.residual, out);
  put_one(cluster.first, out);
  put_one(cluster.euler, out);
  put_one(cluster.collapses, out);
  put_counts(cluster.leaves, out);
}

bool fits(const FaceCurve& curve, std::size_t clusters) {
  return curve.cluster < clusters && curve.face < 6 && curve.closed <= 1;
}
bool is_sense(NormalSense sense) {
  return sense == NormalSense::outward || sense == NormalSense::either;
}

}  // namespace

void put_bytes(const NodeRecord& record, std::vector<std::byte>& out) {
  put_one(RecordHead{record.blocked ? 1u : 0u, record.closes ? 1u : 0u, record.clusters.size(),
                     record.curves.size(), record.pairs.size()},
          out);
  for (const ClusterRecord& cluster : record.clusters) put_cluster(cluster, out);
  put_list(record.curves, out);
  put_list(record.pairs, out);
}

void put_links(const ReducedNode& node, std::vector<std::byte>& out) {
  put_one(ReducedHead{node.leaves.size(), node.nodes.size(), node.links.size()}, out);
  put_list(node.leaves, out);
  put_list(node.nodes, out);
  put_list(node.links, out);
  put_counts(node.counts, out);
}

template <class T>
bool RecordBytes::take_one(T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (rest_.size() < sizeof(T)) return false;
  std::memcpy(static_cast<void*>(&value), rest_.data(), sizeof(T));
  rest_ = rest_.subspan(sizeof(T));
  return true;
}

template <class T>
bool RecordBytes::take_list(std::uint64_t count, std::vector<T>& values) {
  if (count > rest_.size() / sizeof(T)) return false;
  values.resize(count);
  for (T& value : values)
    if (!take_one(value)) return false;
  return true;
}

bool RecordBytes::take_counts(LeafCounts& counts) {
  std::uint64_t levels = 0;
  if (!take_one(levels) || levels > counts.leaves.size()) return false;
  counts = {};
  for (std::size_t l = 0; l < levels; ++l)
    if (!take_one(counts.leaves[l]) || !take_one(counts.errors[l])) return false;
  return true;
}

bool RecordBytes::take_cluster(ClusterRecord& cluster) {
  return take_one(cluster.qef) && take_one(cluster.normals) && take_one(cluster.offset) &&
         take_one(cluster.residual) && take_one(cluster.first) && take_one(cluster.euler) &&
         take_one(cluster.collapses) && take_counts(cluster.leaves) &&
         is_sense(cluster.normals.sense) && cluster.collapses <= 1;
}

bool RecordBytes::take(NodeRecord& record) {
  RecordHead head;
  if (!take_one(head) || head.blocked > 1 || head.closes > 1) return false;
  record.blocked = head.blocked == 1;
  record.closes = head.closes == 1;
  if (head.clusters > rest_.size() / sizeof(Qef)) return false;
  record.clusters.resize(head.clusters);
  for (ClusterRecord& cluster : record.clusters)
    if (!take_cluster(cluster)) return false;
  if (!take_list(head.curves, record.curves) || !take_list(head.pairs, record.pairs)) return false;
  return std::ranges::all_of(record.curves,
                             [&](const FaceCurve& c) { return fits(c, head.clusters); }) &&
         std::ranges::all_of(record.pairs, [&](const CurvePair& p) {
           return p.first < head.curves && p.second < head.curves;
         });
}

bool RecordBytes::take_links(ReducedNode& node) {
  ReducedHead head;
  if (!take_one(head) || !take_list(head.leaves, node.leaves) ||
      !take_list(head.nodes, node.nodes) || !take_list(head.links, node.links) ||
      !take_counts(node.counts))
    return false;
  const auto is_one_of = [](std::uint32_t number, std::uint64_t count) {
    return number == no_cluster || number < count;
  };
  const auto in_order = [](const LinkedNode& a, const LinkedNode& b) {
    return a.code >= b.code || a.first_link > b.first_link;
  };
  return std::ranges::all_of(node.leaves,
                             [](const ClusterLeaf& leaf) {
                               return leaf.level <= max_levels && leaf.shares <= 1;
                             }) &&
         std::ranges::all_of(node.nodes,
                             [&](const LinkedNode& part) {
                               return part.first_link <= head.links && part.covered <= 1;
                             }) &&
         std::ranges::adjacent_find(node.nodes, in_order) == node.nodes.end() &&
         std::ranges::all_of(node.links, [&](const ClusterLink& link) {
           return is_one_of(link.leaf, head.leaves) &&
                  is_one_of(link.root, node.record.clusters.size());
         });
}

}  // namespace voxweld
