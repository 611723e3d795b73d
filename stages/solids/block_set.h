// Blocks of samples that something lies in: a bit each, so coarse that they take little memory.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

class BlockSet {
 public:
  // Without samples all boxes meet it.
  BlockSet() = default;
  // Of the samples [0, size).
  explicit BlockSet(Index3 size) : size_(size) {
    while (count() > most_blocks) ++shift_;
    const Index3 blocks = blocks_of({{}, size_}).size();
    width_ = blocks.x;
    height_ = blocks.y;
    bits_.resize(static_cast<std::size_t>(blocks.x * blocks.y * blocks.z));
  }

  // samples: half-open; what of it lies outside is left out.
  void add(const Box3& samples) {
    const Box3 blocks = blocks_of(intersect(samples, Box3{{}, size_}));
    if (!all_) work_ += static_cast<std::uint64_t>(blocks.count());
    all_ = all_ || work_ > most_work;
    if (all_) return;
    each(blocks, [&](std::size_t block) {
      bits_[block] = true;
      return true;
    });
  }
  // Whether anything may lie in these samples.
  bool meets(const Box3& samples) const {
    if (bits_.empty() || all_) return true;
    return !each(blocks_of(intersect(samples, Box3{{}, size_})),
                 [&](std::size_t block) { return !bits_[block]; });
  }

  std::uint64_t bytes() const { return bits_.capacity() / 8; }

 private:
  static constexpr std::int64_t most_blocks = std::int64_t{1} << 21;
  static constexpr std::uint64_t most_work = std::uint64_t{1} << 28;

  std::int64_t count() const { return blocks_of({{}, size_}).count(); }
  Box3 blocks_of(const Box3& samples) const {
    if (samples.empty()) return {};
    Box3 blocks;
    for (int a = 0; a < 3; ++a) {
      blocks.lo[a] = samples.lo[a] >> shift_;
      blocks.hi[a] = ((samples.hi[a] - 1) >> shift_) + 1;
    }
    return blocks;
  }
  // Until f(block) is false; whether it never was.
  template <class F>
  bool each(const Box3& blocks, F&& f) const {
    for (std::int64_t z = blocks.lo.z; z < blocks.hi.z; ++z)
      for (std::int64_t y = blocks.lo.y; y < blocks.hi.y; ++y)
        for (std::int64_t x = blocks.lo.x; x < blocks.hi.x; ++x)
          if (!f(static_cast<std::size_t>((z * height_ + y) * width_ + x))) return false;
    return true;
  }

  Index3 size_;
  int shift_ = 3;
  std::int64_t width_ = 0, height_ = 0;
  std::vector<bool> bits_;
  std::uint64_t work_ = 0;
  bool all_ = false;
};

}  // namespace voxweld
