#include "pipeline/phantom/porous_field.h"

#include <array>
#include <cmath>

#include "pipeline/phantom/lattice_fields.h"

namespace voxweld {
namespace {

constexpr std::int64_t width = 11;               // of one box
constexpr std::int64_t reach = 3 * (width / 2);  // of three
constexpr std::int64_t taps = 2 * reach + 1;
constexpr std::int64_t ring = 3 * width + 1;  // values the third difference looks at

// Sum of the four bytes of the low half: the white noise. At most 1020, so that after blurring
// along x and y (weights sum to 11^6) it still fits 32 bits.
constexpr std::uint32_t byte_sum(std::uint64_t hash) {
  const auto pairs = static_cast<std::uint32_t>((hash & 0x00ff00ff) + (hash >> 8 & 0x00ff00ff));
  return (pairs & 0xffff) + (pairs >> 16);
}
constexpr double white_mean = 4 * 127.5;
constexpr double white_variance = 4 * (256.0 * 256.0 - 1) / 12;
static_assert(1020ULL * 11 * 11 * 11 * 11 * 11 * 11 < 1ULL << 32);

constexpr std::int64_t wrap(std::int64_t i, std::int64_t size) {
  return (i % size + size) % size;
}

// One step of the triple running sum.
template <class T>
struct Sums {
  T first = 0, second = 0, third = 0;
  constexpr T push(T difference) {
    first += difference;
    second += first;
    third += second;
    return third;
  }
};

// The third difference of v at i, where v[j] for j < 0 counts as 0.
template <class T, class F>
constexpr T third_difference(std::int64_t i, F&& v) {
  const auto at = [&](std::int64_t j) { return j < 0 ? T{0} : static_cast<T>(v(j)); };
  return static_cast<T>(at(i) - 3 * at(i - width) + 3 * at(i - 2 * width) - at(i - 3 * width));
}

// Weights of the triple box, not normalised: what pushing a single 1 gives.
constexpr std::array<double, taps> blur_weights() {
  std::array<double, taps> weights{};
  Sums<std::int64_t> sums;
  for (std::int64_t i = 0; i < taps; ++i)
    weights[static_cast<std::size_t>(i)] = static_cast<double>(sums.push(
        third_difference<std::int64_t>(i, [](std::int64_t j) { return j == 0 ? 1 : 0; })));
  return weights;
}

double squared_weights(std::int64_t size) {
  const auto weights = blur_weights();
  const std::int64_t period = std::min(size, taps);
  double sum = 0;
  for (std::int64_t i = 0; i < period; ++i) {
    double folded = 0;
    for (std::int64_t j = i; j < taps; j += size) folded += weights[static_cast<std::size_t>(j)];
    sum += folded * folded;
  }
  return sum;
}

}  // namespace

// Scratch of blurring one slice along x and y.
struct PorousField::Slice {
  std::vector<std::uint32_t> white;                 // one row with halo
  std::vector<std::uint32_t> rows;                  // the rows blurred along x that y looks back at
  std::vector<std::uint32_t> first, second, third;  // running sums along y, one for each x
};

PorousField::PorousField(std::int64_t size, std::uint64_t seed)
    : size_(size),
      seed_(seed),
      mean_(white_mean * std::pow(static_cast<double>(width), 9)),
      scale_(1 / std::sqrt(blurred_variance(size))) {}

double PorousField::blurred_variance(std::int64_t size) {
  const double axis = squared_weights(size);
  return white_variance * axis * axis * axis;
}

std::uint64_t PorousField::scratch_bytes() const {
  const auto columns = static_cast<std::uint64_t>(block().x * block().y);
  return columns * (ring * sizeof(std::uint32_t) + 3 * sizeof(std::uint64_t)) +
         static_cast<std::uint64_t>(block().x) * (ring + 8) * sizeof(std::uint32_t);
}

// White noise of slice z, blurred along x and y, at the columns of box.
void PorousField::blur_slice(const Box3& box, std::int64_t z, Slice& s, std::uint32_t* out) const {
  const std::int64_t columns = box.size().x, rows = box.size().y + 2 * reach;
  const auto n = static_cast<std::size_t>(columns);
  s.white.resize(n + 2 * reach);
  s.rows.assign(n * ring, 0);
  for (auto* sums : {&s.first, &s.second, &s.third}) sums->assign(n, 0);
  for (std::int64_t i = 0; i < rows; ++i) {
    const std::uint64_t key = row_key(seed_, wrap(box.lo.y - reach + i, size_), z);
    std::int64_t x = wrap(box.lo.x - reach, size_);
    for (std::uint32_t& white : s.white) {
      white = byte_sum(mix_bits(key, static_cast<std::uint64_t>(x)));
      if (++x == size_) x = 0;
    }
    const auto row_at = [&](std::int64_t j) {
      return s.rows.data() + static_cast<std::size_t>((j + ring) % ring) * n;
    };
    std::uint32_t* const blurred = row_at(i);
    Sums<std::uint32_t> sums;
    const std::uint32_t* const w = s.white.data();
    for (std::int64_t j = 0; j < columns + 2 * reach; ++j) {
      const std::uint32_t sum =
          sums.push(third_difference<std::uint32_t>(j, [w](std::int64_t k) { return w[k]; }));
      if (j >= 2 * reach) blurred[j - 2 * reach] = sum;
    }
    // Rows not yet pushed are zero in the ring, as the sums need them.
    const std::uint32_t *b = row_at(i - width), *c = row_at(i - 2 * width),
                        *d = row_at(i - 3 * width);
    for (std::size_t k = 0; k < n; ++k) {
      s.first[k] += blurred[k] - 3 * b[k] + 3 * c[k] - d[k];
      s.second[k] += s.first[k];
      s.third[k] += s.second[k];
    }
    if (i >= 2 * reach) std::copy(s.third.begin(), s.third.end(), out + (i - 2 * reach) * columns);
  }
}

void PorousField::emit_slice(const Box3& box, std::int64_t z, const std::uint64_t* blurred,
                             double* out) const {
  const double white_scale = 1 / std::sqrt(white_variance);
  const auto border = [last = size_ - 1](std::int64_t i) { return i == 0 || i == last; };
  for (std::int64_t y = box.lo.y; y < box.hi.y; ++y) {
    const std::uint64_t key = row_key(seed_, y, z);
    const bool void_row = border(y) || border(z);
    for (std::int64_t x = box.lo.x; x < box.hi.x; ++x) {
      const std::uint64_t hash = mix_bits(key, static_cast<std::uint64_t>(x));
      const double n = (static_cast<double>(byte_sum(hash >> 32)) - white_mean) * white_scale;
      const double w =
          (static_cast<double>(static_cast<std::int64_t>(*blurred++)) - mean_) * scale_;
      const double solid = void_row || border(x) ? -4.0 : w - 0.4;
      *out++ = -(solid + 0.015 * n) * 8;
    }
  }
}

void PorousField::fill(const Box3& box, double /*limit*/, double* out) const {
  const Index3 size = box.size();
  const auto n = static_cast<std::size_t>(size.x * size.y);
  Slice scratch;
  std::vector<std::uint32_t> slices(n * ring, 0);
  std::vector<std::uint64_t> first(n, 0), second(n, 0), third(n, 0);
  const auto slice_at = [&](std::int64_t i) {
    return slices.data() + static_cast<std::size_t>((i + ring) % ring) * n;
  };
  for (std::int64_t i = 0; i < size.z + 2 * reach; ++i) {
    std::uint32_t* const a = slice_at(i);
    blur_slice(box, wrap(box.lo.z - reach + i, size_), scratch, a);
    const std::uint32_t *b = slice_at(i - width), *c = slice_at(i - 2 * width),
                        *d = slice_at(i - 3 * width);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint64_t outer = std::uint64_t{a[k]} - std::uint64_t{d[k]};
      const std::uint64_t inner = std::uint64_t{c[k]} - std::uint64_t{b[k]};
      first[k] += outer + 3 * inner;
      second[k] += first[k];
      third[k] += second[k];
    }
    if (i >= 2 * reach)
      emit_slice(box, box.lo.z + i - 2 * reach, third.data(),
                 out + static_cast<std::size_t>(i - 2 * reach) * n);
  }
}

}  // namespace voxweld
