// Numbers of vertices by their ids.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/morton.h"

namespace voxweld {

// A table of open addressing: a lookup mostly touches one place in memory.
class VertexNumbers {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  // Bytes for each vertex that was reserved: at most two of three places are taken.
  static constexpr std::uint64_t bytes = 18;

  void reserve(std::size_t vertices) {
    if (vertices > most()) grow(vertices);
  }
  void clear() { *this = {}; }
  // The number of the vertex; where it has none, `next` becomes it. next: not `none`.
  std::uint32_t find_or_add(VertexId id, std::uint32_t next) {
    if (count_ == most()) grow(count_ == 0 ? 64 : 2 * count_);
    const std::size_t at = place(id);
    if (numbers_[at] != none) return numbers_[at];
    ids_[at] = id;
    ++count_;
    return numbers_[at] = next;
  }

 private:
  std::size_t most() const { return ids_.size() / 3 * 2; }
  // Where the id is, or would be.
  std::size_t place(VertexId id) const {
    // Neighbours differ in few bits: the product has them all in its upper ones.
    const std::uint64_t mixed = id.bits * 0x9e3779b97f4a7c15u;
    auto at = static_cast<std::size_t>((mixed >> 32) * ids_.size() >> 32);
    while (numbers_[at] != none && ids_[at] != id)
      if (++at == ids_.size()) at = 0;
    return at;
  }
  void grow(std::size_t vertices) {
    VertexNumbers larger;
    larger.ids_.resize((vertices + 1) / 2 * 3 + 3);
    larger.numbers_.resize(larger.ids_.size(), none);
    for (std::size_t i = 0; i < ids_.size(); ++i)
      if (numbers_[i] != none) larger.find_or_add(ids_[i], numbers_[i]);
    *this = std::move(larger);
  }

  std::vector<VertexId> ids_;
  std::vector<std::uint32_t> numbers_;
  std::size_t count_ = 0;
};

}  // namespace voxweld
