// Three ways to the medians of a row: networks where no radius is above 1, a sliding histogram for
// many samples of 8 and 16 bits, bit by bit for the others.
#pragma once

#include <algorithm>
#include <memory>

#include "stages/filter/key_rows.h"
#include "stages/filter/median_networks.h"

namespace voxweld::filter_detail {

// 27 samples. What neighbouring rows and columns have in common is sorted once.
template <class T>
class MedianOfCube {
 public:
  using K = Key<T>;
  explicit MedianOfCube(const KeyRowsShape& shape)
      : pitch_(shape.pitch()), width_(shape.box.size().x), keys_(buffer_of<K>(keys(shape))) {}

  static std::uint64_t bytes(const KeyRowsShape& shape) { return buffer_bytes<K>(keys(shape)); }

  void fill(const KeyRows<T>& rows, std::int64_t y, std::int64_t z, K* out) {
    if (z != z_) next_ = y - 1;
    z_ = z;
    for (; next_ <= y + 1; ++next_) {
      const K* const column[3] = {rows.row(next_, z - 1), rows.row(next_, z),
                                  rows.row(next_, z + 1)};
      sort_three_rows(column, pitch_, triple(next_), pitch_);
    }
    const K* const triples[3] = {triple(y - 1), triple(y), triple(y + 1)};
    K* sorted = keys_.get() + 9 * pitch_;
    sort_nine_rows(triples, pitch_, sorted, pitch_);
    median_of_columns(sorted, pitch_, width_, out);
  }

 private:
  static std::int64_t keys(const KeyRowsShape& shape) { return 18 * shape.pitch(); }
  K* triple(std::int64_t y) { return keys_.get() + (y + 3) % 3 * 3 * pitch_; }

  std::int64_t pitch_, width_, z_ = -1, next_ = 0;
  std::unique_ptr<K[]> keys_;
};

// 1, 3 or 9 samples: as many rows, those along x a step apart.
template <class T>
void fill_from_rows(const KeyRows<T>& rows, const KeyRowsShape& shape, std::int64_t y,
                    std::int64_t z, Key<T>* out) {
  const Index3 r = shape.radius;
  const Key<T>* sources[9] = {};
  std::size_t count = 0;
  for (std::int64_t k = -r.z; k <= r.z; ++k)
    for (std::int64_t j = -r.y; j <= r.y; ++j)
      for (std::int64_t i = 0; i <= 2 * r.x; ++i) sources[count++] = rows.row(y + j, z + k) + i;
  const std::int64_t width = shape.box.size().x;
  if (count == 9)
    median_of_nine(sources, width, out);
  else if (count == 3)
    median_of_three(sources, width, out);
  else
    std::copy_n(sources[0], width, out);
}

// T. S. Huang, G. J. Yang, G. Y. Tang, "A Fast Two-Dimensional Median Filtering Algorithm", IEEE
// Transactions on Acoustics, Speech, and Signal Processing 27(1), 1979. Differs in that whole
// blocks of values are stepped over by their own counts.
template <class K>
class SlidingHistogram {
 public:
  static constexpr int block_bits = sizeof(K) == 1 ? 4 : 6;
  static constexpr std::int64_t values = std::int64_t{1} << (8 * sizeof(K));
  static constexpr std::int64_t blocks = values >> block_bits;

  SlidingHistogram() : counts_(std::make_unique<std::int64_t[]>(values + blocks)) {}
  static std::uint64_t bytes() { return buffer_bytes<std::int64_t>(values + blocks); }

  // rows: of width + 2 radius keys. Leaves the counts at 0.
  void fill(const K* const* rows, std::int64_t count, std::int64_t radius, std::int64_t width,
            K* out) {
    const std::int64_t half = count * (2 * radius + 1) / 2;
    for (std::int64_t x = 0; x < 2 * radius; ++x) add_column(rows, count, x, 1);
    for (std::int64_t x = 0; x < width; ++x) {
      add_column(rows, count, x + 2 * radius, 1);
      out[x] = find(half);
      add_column(rows, count, x, -1);
    }
    for (std::int64_t x = width; x < width + 2 * radius; ++x) add_column(rows, count, x, -1);
  }

 private:
  void add_column(const K* const* rows, std::int64_t count, std::int64_t x, std::int64_t step) {
    std::int64_t* blocks_begin = counts_.get() + values;
    std::int64_t below = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::size_t key = rows[i][x];
      counts_[key] += step;
      blocks_begin[key >> block_bits] += step;
      below += key < at_ ? step : 0;
    }
    below_ += below;
  }

  // The key that has no more than `half` below it, and with those equal to it more than `half`.
  K find(std::int64_t half) {
    constexpr std::size_t block = std::size_t{1} << block_bits;
    const std::int64_t* of_block = counts_.get() + values;
    while (below_ > half) {
      const std::int64_t whole = at_ % block == 0 ? of_block[at_ / block - 1] : 0;
      if (at_ % block == 0 && below_ - whole > half) {
        at_ -= block;
        below_ -= whole;
      } else {
        below_ -= counts_[--at_];
      }
    }
    while (below_ + counts_[at_] <= half) {
      const std::int64_t whole = at_ % block == 0 ? of_block[at_ / block] : 0;
      if (at_ % block == 0 && below_ + whole <= half) {
        at_ += block;
        below_ += whole;
      } else {
        below_ += counts_[at_++];
      }
    }
    return static_cast<K>(at_);
  }

  std::unique_ptr<std::int64_t[]> counts_;  // of each value, then of each block of values
  std::size_t at_ = 0;
  std::int64_t below_ = 0;  // keys below at_
};

// The median's bits from the highest down: a bit is set where no more than half of the keys are
// below
// what that gives. The same steps for every sample, so that loops over the row become vectors. At
// most as many keys as a K can count.
template <class K>
class MedianByBits {
 public:
  static constexpr std::int64_t part = 256;  // of a row, at once: stays in the nearest cache

  MedianByBits(std::int64_t rows, std::int64_t radius)
      : sources_(buffer_of<const K*>(rows * (2 * radius + 1))) {}
  static std::uint64_t bytes(std::int64_t rows, std::int64_t radius) {
    return buffer_bytes<const K*>(rows * (2 * radius + 1));
  }

  void fill(const K* const* rows, std::int64_t count, std::int64_t radius, std::int64_t width,
            K* out) {
    for (std::int64_t begin = 0; begin < width; begin += part) {
      std::size_t keys = 0;
      for (std::int64_t i = 0; i < count; ++i)
        for (std::int64_t k = 0; k <= 2 * radius; ++k) sources_[keys++] = rows[i] + begin + k;
      fill_part(keys, std::min(part, width - begin), out + begin);
    }
  }

 private:
  void fill_part(std::size_t keys, std::int64_t width, K* __restrict out) {
    const K half = static_cast<K>(keys / 2);
    std::fill_n(out, width, K{});
    for (K bit = static_cast<K>(K{1} << (8 * sizeof(K) - 1)); bit != 0;
         bit = static_cast<K>(bit >> 1)) {
      K candidates[part], below[part];
      for (std::int64_t x = 0; x < width; ++x) candidates[x] = static_cast<K>(out[x] | bit);
      std::fill_n(below, width, K{});
      std::size_t i = 0;
      for (; i + 5 <= keys; i += 5) count_five(sources_.get() + i, candidates, width, below);
      for (; i < keys; ++i)
        for (std::int64_t x = 0; x < width; ++x)
          below[x] = static_cast<K>(below[x] + (sources_[i][x] < candidates[x]));
      for (std::int64_t x = 0; x < width; ++x) out[x] = below[x] <= half ? candidates[x] : out[x];
    }
  }

  // Inlined, it does not become vectors (GCC 12).
  [[gnu::noinline]] static void count_five(const K* const* sources, const K* candidates,
                                           std::int64_t width, K* __restrict below) {
    const K *a = sources[0], *b = sources[1], *c = sources[2], *d = sources[3], *e = sources[4];
    for (std::int64_t x = 0; x < width; ++x) {
      const K t = candidates[x];
      const K ab = static_cast<K>((a[x] < t) + (b[x] < t)),
              cd = static_cast<K>((c[x] < t) + (d[x] < t));
      below[x] = static_cast<K>(below[x] + ab + cd + (e[x] < t));
    }
  }

  std::unique_ptr<const K*[]> sources_;
};

}  // namespace voxweld::filter_detail
