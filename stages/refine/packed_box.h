// Boxes in few bits, of which one comparison tells whether two of them may meet.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "storage/types/lattice_box.h"

namespace voxweld {

// Eight numbers that are compared at once. All machines have registers of this width; compilers take
// wider ones apart.
using EightShorts = std::int16_t __attribute__((vector_size(16)));

inline bool all_set(EightShorts comparison) {
  std::uint64_t halves[2];
  std::memcpy(halves, &comparison, sizeof halves);
  return (halves[0] & halves[1]) == ~std::uint64_t{0};
}

// A bit for each that is set.
inline std::uint32_t bits_of(EightShorts comparison) {
#ifdef __SSE2__
  return static_cast<std::uint32_t>(
             __builtin_ia32_pmovmskb128(__builtin_ia32_packsswb128(comparison, comparison))) &
         0xffu;
#else
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) bits |= comparison[i] != 0 ? std::uint32_t{1} << i : 0;
  return bits;
#endif
}

// Rounds corners outwards to 16 bits, relative to a place near which the boxes lie.
class BoxPacker {
 public:
  explicit BoxPacker(const LatticeBox& around) : origin_(around.lo) {
    for (std::size_t a = 0; a < 3; ++a)
      while ((around.hi[a] - around.lo[a]) >> shift_ > largest / 2) ++shift_;
  }
  std::int16_t operator()(std::int32_t coordinate, std::size_t axis) const {
    // One below a multiple is rounded to it, and one above: so both ends of a box may be.
    return static_cast<std::int16_t>(
        std::clamp((coordinate - origin_[axis]) >> shift_, -largest, largest));
  }

 private:
  static constexpr std::int32_t largest = 32000;
  LatticePoint origin_;
  int shift_ = 0;
};

// A box and a number.
struct PackedBox {
  EightShorts lanes;  // the low corner, the high one negated, the number in two

  PackedBox(const BoxPacker& pack, const LatticeBox& box, std::uint32_t number) {
    for (std::size_t a = 0; a < 3; ++a) {
      lanes[a] = pack(box.lo[a], a);
      lanes[a + 3] = static_cast<std::int16_t>(-pack(box.hi[a], a));
    }
    lanes[6] = static_cast<std::int16_t>(number & 0xffffu);
    lanes[7] = static_cast<std::int16_t>(number >> 16);
  }
  // Until it meets all that the other one meets. It keeps its number.
  void extend(const PackedBox& other) {
    for (std::size_t k = 0; k < 6; ++k)
      if (other.lanes[k] < lanes[k]) lanes[k] = other.lanes[k];
  }
  std::uint32_t number() const {
    return static_cast<std::uint16_t>(lanes[6]) |
           static_cast<std::uint32_t>(static_cast<std::uint16_t>(lanes[7])) << 16;
  }
};

// One box to hold others against.
class BoxQuery {
 public:
  BoxQuery(const BoxPacker& pack, const LatticeBox& box) : BoxQuery(PackedBox(pack, box, 0)) {}
  explicit BoxQuery(const PackedBox& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      most_[a] = static_cast<std::int16_t>(-box.lanes[a + 3]);
      most_[a + 3] = static_cast<std::int16_t>(-box.lanes[a]);
    }
    most_[6] = most_[7] = INT16_MAX;  // any number will do
  }
  bool meets(const PackedBox& box) const { return all_set(box.lanes <= most_); }

 private:
  EightShorts most_{};
};

// Some boxes to hold others against, eight at a time.
class BoxQueries {
 public:
  static constexpr std::size_t most = 64;

  explicit BoxQueries(const BoxPacker& pack) : pack_(pack) {}
  void add(const LatticeBox& box) {
    Group& group = groups_[count_ / lanes];
    if (count_ % lanes == 0)
      for (std::size_t k = 0; k < 6; ++k) group.most[k] = EightShorts{} + INT16_MIN;  // none
    for (std::size_t a = 0; a < 3; ++a) {
      group.most[a][count_ % lanes] = pack_(box.hi[a], a);
      group.most[a + 3][count_ % lanes] = static_cast<std::int16_t>(-pack_(box.lo[a], a));
    }
    if (count_++ == 0) around_ = box;
    around_.extend(box);
  }
  // Precondition: there is a box.
  const LatticeBox& around() const { return around_; }

  // A bit for each that may meet the box, the lowest for the one that was added first.
  std::uint64_t meeting(const PackedBox& box) const {
    std::uint64_t bits = 0;
    for (std::size_t first = 0; first < count_; first += lanes)
      bits |= std::uint64_t{meeting(groups_[first / lanes], box.lanes)} << first;
    return bits;
  }

 private:
  static constexpr std::size_t lanes = 8;
  struct Group {
    EightShorts most[6];
  };
  static std::uint32_t meeting(const Group& group, const EightShorts& box) {
    EightShorts meets = group.most[0] >= box[0];
    for (std::size_t k = 1; k < 6; ++k) meets &= group.most[k] >= box[k];
    return bits_of(meets);
  }

  const BoxPacker& pack_;
  std::array<Group, most / lanes> groups_;
  LatticeBox around_;
  std::size_t count_ = 0;
};

}  // namespace voxweld
