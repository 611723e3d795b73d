// The least a contouring has to do, as a yardstick for its speed on a machine: one pass over a
// uint16 volume in memory that counts the cells with a sign change.
// usage: bare_pass VOLUME ISOVALUE [THREADS]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "storage/readers/open_volume.h"
#include "storage/support/error.h"

namespace {

using namespace voxweld;

struct Slab {
  std::int64_t begin = 0, end = 0;  // of cells in z
  std::int64_t active = 0;
};

// Cells between rows y, y + 1 of slices z, z + 1: a vectorised or and and of eight corners.
std::int64_t count_row(const std::uint16_t* const rows[4], std::int64_t width,
                       std::uint16_t threshold, std::vector<std::uint8_t>& sum) {
  for (std::int64_t x = 0; x < width; ++x)
    sum[static_cast<std::size_t>(x)] =
        static_cast<std::uint8_t>((rows[0][x] <= threshold) + (rows[1][x] <= threshold) +
                                  (rows[2][x] <= threshold) + (rows[3][x] <= threshold));
  std::int64_t active = 0;
  for (std::int64_t x = 0; x + 1 < width; ++x) {
    const int corners = sum[static_cast<std::size_t>(x)] + sum[static_cast<std::size_t>(x) + 1];
    active += static_cast<int>(corners != 0) & static_cast<int>(corners != 8);
  }
  return active;
}

void count_slab(const std::uint16_t* data, Index3 size, std::uint16_t threshold, Slab& slab) {
  std::vector<std::uint8_t> sum(static_cast<std::size_t>(size.x));
  for (std::int64_t z = slab.begin; z < slab.end; ++z)
    for (std::int64_t y = 0; y + 1 < size.y; ++y) {
      const std::uint16_t* first = data + (z * size.y + y) * size.x;
      const std::uint16_t* const rows[4] = {first, first + size.x, first + size.x * size.y,
                                            first + size.x * (size.y + 1)};
      slab.active += count_row(rows, size.x, threshold, sum);
    }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    fmt::print(stderr, "usage: bare_pass VOLUME ISOVALUE [THREADS]\n");
    return 2;
  }
  const int threads = argc > 3 ? std::atoi(argv[3]) : 2;
  const auto threshold = static_cast<std::uint16_t>(std::atof(argv[2]));
  InputSpec spec;
  spec.path = argv[1];
  const auto source = open_volume(spec);
  const Index3 size = source->info().geometry.size;
  if (source->info().type != SampleType::u16) throw InputError("bare_pass takes uint16 volumes");
  std::vector<std::uint16_t> data(static_cast<std::size_t>(size.x * size.y * size.z));
  source->read({{}, size}, reinterpret_cast<std::byte*>(data.data()));
  double best = 1e300;
  std::int64_t active = 0;
  for (int round = 0; round < 5; ++round) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<Slab> slabs;
    for (int i = 0; i < threads; ++i)
      slabs.push_back({(size.z - 1) * i / threads, (size.z - 1) * (i + 1) / threads, 0});
    std::vector<std::thread> workers;
    for (Slab& slab : slabs)
      workers.emplace_back([&] { count_slab(data.data(), size, threshold, slab); });
    for (std::thread& worker : workers) worker.join();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    active = 0;
    for (const Slab& slab : slabs) active += slab.active;
  }
  fmt::print("{}: {} active cells, bare pass {:.1f} ms on {} threads\n", argv[1], active,
             1e3 * best, threads);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
