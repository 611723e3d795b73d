// Edges that wait to be collapsed, those that cost least first.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace voxweld {

struct QueuedEdge {
  std::uint32_t u, v;
  std::uint32_t version_u, version_v;  // of its ends when it was put in
};

// A queue of buckets: costs in one bucket differ by 1/16 at most. Within a bucket the one that came
// first goes first, so neighbouring edges take turns. Nothing is ever compared, which is what makes it
// faster than a heap: of the edges that are put in, most are out of date when their turn comes.
class EdgeQueue {
 public:
  // cost: not negative.
  void push(double cost, const QueuedEdge& edge) {
    const std::size_t bucket = bucket_of(cost);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].edges.push_back(edge);
    if (bucket < first_) first_ = bucket;
  }
  // False where none is left.
  bool pop(QueuedEdge& edge) {
    for (; first_ < buckets_.size(); ++first_) {
      Bucket& bucket = buckets_[first_];
      if (bucket.next < bucket.edges.size()) {
        edge = bucket.edges[bucket.next++];
        return true;
      }
      bucket = {};
    }
    return false;
  }

 private:
  // Exponent and four bits of the fraction, of at least 2^-40.
  static std::size_t bucket_of(double cost) {
    constexpr int fraction_bits = 52, kept = 4;
    constexpr std::uint64_t least = std::bit_cast<std::uint64_t>(0x1p-40) >> (fraction_bits - kept);
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(cost) >> (fraction_bits - kept);
    return bits <= least ? 0 : static_cast<std::size_t>(bits - least);
  }
  struct Bucket {
    std::vector<QueuedEdge> edges;
    std::size_t next = 0;
  };
  std::vector<Bucket> buckets_;
  std::size_t first_ = 0;
};

}  // namespace voxweld
