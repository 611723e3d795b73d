// What one halo read of a build task costs: a box out of a raw volume of 512^3 16-bit samples, in
// the page cache.
#include <benchmark/benchmark.h>

#include "storage/support/file_io.h"
#include "storage/volumes/raw_reader.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

std::filesystem::path volume_file() {
  static const testing::TempDirectory directory;
  static const std::filesystem::path path = [] {
    AtomicFile file(directory / "a.raw");
    const std::vector<std::byte> slice(std::size_t{512} * 512 * 2, std::byte{42});
    for (int z = 0; z < 512; ++z) file.append(slice);
    file.commit(Durability::rename_only);
    return directory / "a.raw";
  }();
  return path;
}

void read_boxes(benchmark::State& state, Index3 size, std::endian order) {
  RawLayout layout;
  layout.path = volume_file();
  layout.size = {512, 512, 512};
  layout.type = SampleType::u16;
  layout.byte_order = order;
  const auto source = open_raw(layout);
  const Box3 box{{64, 128, 128}, Index3{64, 128, 128} + size};
  std::vector<std::byte> out(static_cast<std::size_t>(box.count()) * 2);
  for (auto _ : state) {
    source->read(box, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(out.size()));
}

BENCHMARK_CAPTURE(read_boxes, little_261x69x69, Index3{261, 69, 69}, std::endian::little);
BENCHMARK_CAPTURE(read_boxes, big_261x69x69, Index3{261, 69, 69}, std::endian::big);
BENCHMARK_CAPTURE(read_boxes, little_69x69x69, Index3{69, 69, 69}, std::endian::little);
BENCHMARK_CAPTURE(read_boxes, little_261x261x69, Index3{261, 261, 69}, std::endian::little);

}  // namespace
}  // namespace voxweld

BENCHMARK_MAIN();
