// Random volumes of all types through all filters, whole and in boxes, against the plain versions.
#include <gtest/gtest.h>

#include "tests/stages/filter/plain_filters.h"

namespace voxweld {
namespace {

using testing::Grid;

template <class T>
class RandomFilters : public ::testing::Test {
 protected:
  static constexpr int rounds = 24;

  Index3 size() { return testing::random_index(1, round_ % 3 == 0 ? 20 : 7, random_); }
  Grid<T> grid(Index3 n) { return testing::random_grid<T>(n, random_, ++round_ % 2 == 0); }
  static SampleGrid shape(const Grid<T>& in) { return {in.size, testing::type_of<T>()}; }

  // Any box has the bits of the whole.
  template <class Out>
  void expect_boxes(const FilterKernel& kernel, const Grid<T>& in, const std::vector<Out>& whole) {
    const Grid<Out> all{kernel.output().size, whole};
    for (int i = 0; i < 6; ++i) {
      const Box3 box = testing::random_box(all.size, random_);
      const Box3 needs = kernel.needs(box);
      ASSERT_FALSE(needs.empty());
      ASSERT_TRUE((Box3{{}, in.size}.contains(needs)));
      std::vector<Out> expected;
      each_index(box, [&](Index3 p) { expected.push_back(all.at(p)); });
      const std::vector<Out> got = testing::filtered<Out>(kernel, in, box);
      ASSERT_EQ(0, std::memcmp(got.data(), expected.data(), got.size() * sizeof(Out)));
    }
  }

  // Integers may differ by one where the number lies halfway, 64-bit ones by what sums of doubles
  // lose; floats by what is lost to rounding, relative to the largest sample.
  template <class Out>
  void expect_near(const std::vector<Out>& got, const Grid<double>& expected, double largest) {
    ASSERT_EQ(got.size(), expected.values.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      const double e = expected.values[i], halfway = std::abs(e - std::floor(e) - 0.5);
      const Out rounded = testing::plain_rounded<Out>(static_cast<long double>(e));
      double allowed = 1e-13 * largest;
      if (std::is_same_v<Out, float>) allowed += 1e-7 * largest;
      if (std::is_integral_v<Out> && halfway < 1e-9 + 1e-13 * largest) allowed += 1;
      if (std::is_integral_v<Out> && allowed < 1) allowed = 0;
      ASSERT_LE(std::abs(static_cast<long double>(got[i]) - static_cast<long double>(rounded)),
                static_cast<long double>(allowed))
          << "sample " << i << ": " << +got[i] << " instead of " << e;
    }
  }

  // Into the type of the input, into bytes and into floats.
  template <class Make>
  void expect_sums(const Grid<T>& in, const Grid<double>& expected, Make&& make,
                   bool one_to_one = false) {
    double largest = 1;
    for (const T v : in.values) largest = std::max(largest, std::abs(static_cast<double>(v)));
    const auto check = [&](auto tag) {
      using Out = decltype(tag);
      const std::unique_ptr<FilterKernel> kernel = make(testing::type_of<Out>());
      EXPECT_EQ(kernel->one_to_one(), one_to_one);
      const auto whole = testing::filtered<Out>(*kernel, in);
      expect_near(whole, expected, largest);
      expect_boxes(*kernel, in, whole);
    };
    check(T{});
    check(std::int8_t{});
    check(std::uint32_t{});
    check(float{});
    check(double{});
  }

  template <class Plain>
  void expect_exact(const FilterKernel& kernel, const Grid<T>& in, const Plain& expected) {
    const auto whole = testing::filtered<T>(kernel, in);
    ASSERT_EQ(kernel.output().size, expected.size);
    ASSERT_EQ(whole, expected.values);
    expect_boxes(kernel, in, whole);
  }

  std::mt19937_64 random_{7};
  int round_ = 0;
};

using Types =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(RandomFilters, Types);

TYPED_TEST(RandomFilters, Median) {
  for (int i = 0; i < 4 * this->rounds; ++i) {
    const auto in = this->grid(this->size());
    // The cube of 27, smaller ones, larger ones, larger ones than the volume.
    const Index3 radius =
        i % 4 == 0 ? splat(1) : testing::random_index(0, i % 4 == 1 ? 1 : 1 + i % 5, this->random_);
    SCOPED_TRACE(::testing::Message()
                 << "radius " << radius.x << ' ' << radius.y << ' ' << radius.z << " round " << i);
    const auto kernel = median_kernel(this->shape(in), radius);
    this->expect_exact(*kernel, in, testing::plain_median(in, radius));
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(RandomFilters, Mean) {
  for (int i = 0; i < this->rounds; ++i) {
    const auto in = this->grid(this->size());
    const Index3 radius = testing::random_index(0, i % 2 == 0 ? 1 : 5, this->random_);
    this->expect_sums(in, testing::plain_mean(in, radius),
                      [&](SampleType type) { return mean_kernel(this->shape(in), radius, type); });
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(RandomFilters, Gaussian) {
  for (int i = 0; i < this->rounds; ++i) {
    const auto in = this->grid(testing::random_index(1, 9, this->random_));
    Vec3 sigma;
    for (int axis = 0; axis < 3; ++axis)
      if (this->random_() % 4 != 0) sigma[axis] = static_cast<double>(this->random_() % 90) / 64;
    this->expect_sums(in, testing::plain_gaussian(in, sigma), [&](SampleType type) {
      return gaussian_kernel(this->shape(in), sigma, type);
    });
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(RandomFilters, Downsample) {
  for (int i = 0; i < this->rounds; ++i) {
    const auto in = this->grid(this->size());
    const Index3 factor = min(in.size, testing::random_index(1, i % 2 == 0 ? 2 : 4, this->random_));
    const SampleGrid shape = this->shape(in);
    this->expect_sums(in, testing::plain_block_mean(in, factor), [&](SampleType type) {
      return downsample_kernel(shape, factor, DownsampleMethod::mean, type);
    });
    this->expect_exact(*downsample_kernel(shape, factor, DownsampleMethod::max, shape.type), in,
                       testing::plain_block_max(in, factor));
    this->expect_exact(*downsample_kernel(shape, factor, DownsampleMethod::mode, shape.type), in,
                       testing::plain_block_mode(in, factor));
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(RandomFilters, FlipAndPermute) {
  using T = TypeParam;
  const std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int i = 0; i < this->rounds; ++i) {
    Index3 n = testing::random_index(1, 20, this->random_);
    if (i % 4 == 0) n[i / 4 % 3] += 40;  // more than one square of the copying
    const auto in = this->grid(n);
    const std::array<bool, 3> turn{i % 2 == 1, i / 2 % 2 == 1, i / 4 % 2 == 1};
    const auto flip = flip_kernel(this->shape(in), turn);
    EXPECT_TRUE(flip->one_to_one());
    this->expect_exact(*flip, in, Grid<T>::made(n, [&](Index3 p) {
      for (int a = 0; a < 3; ++a)
        if (turn[static_cast<std::size_t>(a)]) p[a] = n[a] - 1 - p[a];
      return in.at(p);
    }));
    const auto& order = orders[static_cast<std::size_t>(i) % 6];
    const auto permute = permute_kernel(this->shape(in), order);
    EXPECT_TRUE(permute->one_to_one());
    const Index3 turned{n[order[0]], n[order[1]], n[order[2]]};
    this->expect_exact(*permute, in, Grid<T>::made(turned, [&](Index3 p) {
      Index3 q;
      for (int a = 0; a < 3; ++a) q[order[static_cast<std::size_t>(a)]] = p[a];
      return in.at(q);
    }));
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(RandomFilters, Window) {
  using T = TypeParam;
  for (int i = 0; i < this->rounds; ++i) {
    const auto in = this->grid(this->size());
    double least = static_cast<double>(in.values[0]), most = least;
    for (const T v : in.values) {
      least = std::min(least, static_cast<double>(v));
      most = std::max(most, static_cast<double>(v));
    }
    WindowParameters p{.lo = 0.75 * least + 0.25 * most, .hi = 0.25 * least + 0.75 * most + 1};
    if (i % 3 == 1) p.scale = {10.25, 200};
    if (i % 3 == 2) p.scale = {90, -20};
    const auto expected = Grid<double>::made(in.size, [&](Index3 at) {
      const long double v = std::clamp(static_cast<double>(in.at(at)), p.lo, p.hi);
      if (!p.scale) return static_cast<double>(v);
      const long double share = (v - p.lo) / (static_cast<long double>(p.hi) - p.lo);
      const auto [a, b] = *p.scale;
      return static_cast<double>(a * (1 - share) + b * share);
    });
    this->expect_sums(
        in, expected,
        [&](SampleType type) {
          p.type = type;
          return window_kernel(this->shape(in), p);
        },
        true);
    if (this->HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace voxweld
