// How many samples a second each filter makes on one thread, of 256^3 samples in boxes of
// 256 x 256 x 32. Prints a line each: type, filter, millions of samples a second.
// usage: filter_speed [FILTER]    only the filters whose name begins so
// tests/measure/filter_speed.py compares with scipy.ndimage.
#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "stages/filter/kernel.h"

namespace {

using namespace voxweld;

constexpr std::int64_t side = 256, slab = 32;
constexpr double enough_seconds = 1;  // of one filter: the rest of the volume is left out

template <class T>
std::vector<T> noisy_ball() {
  std::mt19937 random(1);
  std::vector<T> values;
  each_index(splat(side), [&](Index3 p) {
    const Index3 q = p - splat(side / 2);
    const bool inside = q.x * q.x + q.y * q.y + q.z * q.z < side * side / 9;
    const double share = (inside ? 0.6 : 0.2) + static_cast<double>(random() % 1000) / 5000;
    values.push_back(static_cast<T>(share * (sizeof(T) == 1 ? 255 : 65535)));
  });
  return values;
}

struct Entry {
  std::string name;
  std::unique_ptr<FilterKernel> kernel;
};

std::vector<Entry> filters_of(SampleType type) {
  const SampleGrid grid{splat(side), type};
  std::vector<Entry> entries;
  const auto add = [&](const char* name, std::unique_ptr<FilterKernel> kernel) {
    entries.push_back({name, std::move(kernel)});
  };
  add("gaussian-1", gaussian_kernel(grid, {1, 1, 1}, type));
  add("gaussian-2", gaussian_kernel(grid, {2, 2, 2}, type));
  add("mean-1", mean_kernel(grid, splat(1), type));
  add("median-1", median_kernel(grid, splat(1)));
  add("median-2", median_kernel(grid, splat(2)));
  add("downsample-mean-2", downsample_kernel(grid, splat(2), DownsampleMethod::mean, type));
  add("downsample-mode-2", downsample_kernel(grid, splat(2), DownsampleMethod::mode, type));
  add("window", window_kernel(grid, {.lo = 10, .hi = 200, .scale = {{0, 255}}, .type = type}));
  add("permute-zyx", permute_kernel(grid, {2, 1, 0}));
  return entries;
}

// Samples of the input a second. A box's samples are copied beforehand, as a reader would hand them
// over.
template <class T>
double speed_of(const FilterKernel& kernel, const std::vector<T>& values) {
  double seconds = 0;
  std::int64_t slices = 0;
  const Index3 size = kernel.output().size;
  std::vector<T> samples, out;
  for (std::int64_t z = 0; z < size.z && seconds < enough_seconds; z += slab) {
    const Box3 box{{0, 0, z}, {size.x, size.y, std::min(z + slab, size.z)}};
    samples.clear();
    each_index(kernel.needs(box), [&](Index3 p) {
      samples.push_back(values[static_cast<std::size_t>((p.z * side + p.y) * side + p.x)]);
    });
    slices += box.size().z;
    out.assign(static_cast<std::size_t>(box.count()), T{});
    const auto start = std::chrono::steady_clock::now();
    kernel.apply(box, std::as_bytes(std::span(samples)), std::as_writable_bytes(std::span(out)));
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return static_cast<double>(side * side * side) * static_cast<double>(slices) /
         (static_cast<double>(size.z) * seconds);
}

template <class T>
void measure(SampleType type, const std::string& prefix) {
  const std::vector<T> values = noisy_ball<T>();
  for (const Entry& entry : filters_of(type)) {
    if (!entry.name.starts_with(prefix)) continue;
    double best = 0;
    for (int i = 0; i < 3; ++i) best = std::max(best, speed_of(*entry.kernel, values));
    fmt::print("{} {} {:.2f}\n", sample_type_name(type), entry.name, best / 1e6);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string prefix = argc > 1 ? argv[1] : "";
  measure<std::uint8_t>(SampleType::u8, prefix);
  measure<std::uint16_t>(SampleType::u16, prefix);
  measure<float>(SampleType::f32, prefix);
}
