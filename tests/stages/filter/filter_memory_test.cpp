// Holds scratch_bytes against every byte that a filter allocates.
#include <gtest/gtest.h>

#include "tests/stages/filter/plain_filters.h"
#include "tests/support/allocation_count.h"

namespace voxweld {
namespace {

std::uint64_t taken_by(const FilterKernel& kernel, const Box3& box) {
  const auto bytes_of = [](const Box3& b, SampleType type) {
    return static_cast<std::size_t>(b.count()) * sample_bytes(type);
  };
  const std::vector<std::byte> samples(bytes_of(kernel.needs(box), kernel.input().type));
  std::vector<std::byte> out(bytes_of(box, kernel.output().type));
  const std::uint64_t before = testing::live_bytes();
  testing::forget_peak();
  kernel.apply(box, samples, out);
  return testing::peak_bytes() - before;
}

// Enough, and not much more than what is taken.
void expect_enough(const FilterKernel& kernel, const Box3& box) {
  const std::uint64_t taken = taken_by(kernel, box), said = kernel.scratch_bytes(box);
  EXPECT_LE(taken, said);
  EXPECT_LE(said, taken + 65536);
}

void expect_enough_of_all(const SampleGrid& grid, const Box3& box) {
  for (const SampleType type : {grid.type, SampleType::f64}) {
    for (const Vec3 sigma : {Vec3{}, Vec3{1, 1, 1}, Vec3{0, 9, 0.5}})
      expect_enough(*gaussian_kernel(grid, sigma, type), box);
    for (const Index3 radius : {Index3{}, splat(1), Index3{30, 0, 50}, splat(40)})
      expect_enough(*mean_kernel(grid, radius, type), box);
    expect_enough(*window_kernel(grid, {.lo = 0, .hi = 9, .type = type}), box);
  }
  for (const Index3 radius : {Index3{}, splat(1), Index3{1, 0, 1}, Index3{9, 0, 1}, splat(3)})
    expect_enough(*median_kernel(grid, radius), box);
  expect_enough(*flip_kernel(grid, {true, false, true}), box);
  for (const auto method :
       {DownsampleMethod::mean, DownsampleMethod::max, DownsampleMethod::mode}) {
    const auto kernel = downsample_kernel(grid, {3, 2, 1}, method, grid.type);
    expect_enough(*kernel, intersect(box, {{}, kernel->output().size}));
  }
}

TEST(FilterMemory, IsWhatIsSaid) {
  for (int type = 0; type < 10; ++type) {
    SCOPED_TRACE(type);
    const SampleGrid grid{{90, 40, 30}, static_cast<SampleType>(type)};
    expect_enough_of_all(grid, {{}, {90, 40, 30}});
    expect_enough_of_all(grid, {{3, 5, 10}, {67, 12, 14}});
    expect_enough_of_all(grid, {{20, 3, 29}, {21, 4, 30}});
  }
}

}  // namespace
}  // namespace voxweld
