#include "stages/filter/block_mask.h"

#include <array>
#include <cassert>

namespace voxweld {
namespace {

using RowFlags = std::array<std::uint8_t, most_block_side>;

std::uint64_t packed(const RowFlags& flags) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < flags.size(); i += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, flags.data() + i, sizeof eight);
    bits |= (eight * 0x0102040810204080U >> 56) << i;  // the lowest bit of each byte, side by side
  }
  return bits;
}

// Bytes first: the compiler compares many samples at once that way.
template <class T>
std::uint64_t inside_row(const T* samples, std::size_t count, const InsideTest<T>& test) {
  if (test.never) return 0;
  RowFlags flags{};
  const T threshold = test.threshold;
  if (test.above)
    for (std::size_t x = 0; x < count; ++x) flags[x] = samples[x] >= threshold ? 1 : 0;
  else
    for (std::size_t x = 0; x < count; ++x) flags[x] = samples[x] <= threshold ? 1 : 0;
  return packed(flags);
}

template <class T>
struct Extremes {
  bool empty = true;
  T least{}, greatest{};

  void add_row(const T* samples, std::size_t count) {
    std::size_t x = 0;
    if (empty) {
      while (x < count && samples[x] != samples[x]) ++x;  // NaNs
      if (x == count) return;
      least = greatest = samples[x];
      empty = false;
    }
    T lo = least, hi = greatest;
    for (; x < count; ++x) {
      lo = samples[x] < lo ? samples[x] : lo;
      hi = samples[x] > hi ? samples[x] : hi;
    }
    least = lo;
    greatest = hi;
  }
  // Of 0 and -0 the one that is no matter of the order.
  StoredRange range() const {
    const T zero{};
    return {empty, stored_bits(least == zero ? zero : least),
            stored_bits(greatest == zero ? zero : greatest)};
  }
};

// Returns the part's range where `ranged`.
template <class T>
StoredRange mask_of(const T* samples, Index3 held, const Box3& part, const SurfaceSide& side,
                    BlockMask& mask, bool ranged) {
  const InsideTest<T> test = make_inside_test<T>(side.isovalue, side.inside);
  const auto count = static_cast<std::size_t>(mask.size.x);
  const std::uint64_t all = ~std::uint64_t{0} >> (most_block_side - mask.size.x);
  Extremes<T> extremes;
  std::uint64_t* row = mask.rows.data();
  for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
    for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
      const T* first = samples + ((z * held.y + y) * held.x + part.lo.x);
      const std::uint64_t inside = inside_row(first, count, test);
      *row++ = side.within ? inside : all & ~inside;
      if (ranged) extremes.add_row(first, count);
    }
  return extremes.range();
}

}  // namespace

void mask_samples(SampleType type, std::span<const std::byte> samples, Index3 held,
                  const Box3& part, const SurfaceSide& side, BlockMask& mask, StoredRange* range) {
  mask.size = part.size();
  assert(!part.empty() && mask.size.x <= most_block_side);
  mask.rows.resize(static_cast<std::size_t>(mask.size.y * mask.size.z));
  const StoredRange found = dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    return mask_of(reinterpret_cast<const T*>(samples.data()), held, part, side, mask,
                   range != nullptr);
  });
  if (range != nullptr) *range = merge(type, *range, found);
}

}  // namespace voxweld
