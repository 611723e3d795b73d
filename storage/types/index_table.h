// An open-addressing hash table of 32-bit indices into an array the caller keeps: finds the index
// whose element equals a key. Holds no keys itself, so it costs 5 to 11 bytes an element.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "storage/types/morton.h"

namespace voxweld {

// A full-avalanche mix of 64 bits (the finalizer of MurmurHash3).
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v ^= v >> 33;
  v *= 0xff51afd7ed558ccdULL;
  v ^= v >> 33;
  v *= 0xc4ceb9fe1a85ec53ULL;
  return v ^ v >> 33;
}

// Hash: std::uint64_t(std::uint32_t index), the well-mixed hash of an element already in.
template <class Hash>
class IndexTable {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  explicit IndexTable(Hash hash) : hash_(hash) {}

  // The element with this hash for which equal(index) holds, or none.
  template <class Equal>
  std::uint32_t find(std::uint64_t hash, Equal equal) const {
    if (slots_.empty()) return none;
    for (std::size_t at = hash & mask();; at = (at + 1) & mask()) {
      if (slots_[at] == none || equal(slots_[at])) return slots_[at];
    }
  }
  // Precondition: no equal element is in.
  void insert(std::uint64_t hash, std::uint32_t index) {
    if (10 * (count_ + 1) > 8 * slots_.size()) grow(2 * slots_.size());
    place(hash, index);
    ++count_;
  }
  void reserve(std::size_t count) {
    if (count * 10 > slots_.size() * 8) grow(std::bit_ceil(count * 10 / 8 + 1));
  }
  void clear() {
    slots_.clear();
    count_ = 0;
  }

 private:
  std::size_t mask() const { return slots_.size() - 1; }
  void place(std::uint64_t hash, std::uint32_t index) {
    std::size_t at = hash & mask();
    while (slots_[at] != none) at = (at + 1) & mask();
    slots_[at] = index;
  }
  void grow(std::size_t size) {
    const std::vector<std::uint32_t> old = std::move(slots_);
    slots_.assign(std::max<std::size_t>(size, 16), none);
    for (const std::uint32_t index : old) {
      if (index != none) place(hash_(index), index);
    }
  }

  Hash hash_;
  std::vector<std::uint32_t> slots_;
  std::size_t count_ = 0;
};

// Of vertices by their ids. The array of these outlives it and stays where it is.
struct VertexIdHash {
  const std::vector<VertexId>* ids;
  std::uint64_t operator()(std::uint32_t i) const { return mix_bits((*ids)[i].bits); }
};
using VertexTable = IndexTable<VertexIdHash>;

}  // namespace voxweld
