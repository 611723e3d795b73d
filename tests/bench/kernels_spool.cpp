// What goes to disk and comes back, through the page cache: scratch files.
#include <filesystem>
#include <random>
#include <span>

#include "storage/support/external_sorter.h"
#include "tests/bench/kernels_support.h"

namespace voxweld::bench {
namespace {

constexpr std::size_t spool_bytes = std::size_t{8} << 20, record_bytes = 64;

std::vector<std::byte> random_bytes(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

void write_records(RunFile& file, std::span<const std::byte> bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += record_bytes)
    file.write(bytes.subspan(at, record_bytes));
}

void spool_write(benchmark::State& state) {
  const std::vector<std::byte> bytes = random_bytes(spool_bytes);
  while (state.KeepRunning()) {
    RunFile file(std::filesystem::temp_directory_path());
    write_records(file, bytes);
    benchmark::DoNotOptimize(file.end_run());
  }
  count(state, spool_bytes / record_bytes, spool_bytes);
}
BENCHMARK(spool_write)->Unit(benchmark::kMillisecond);

void spool_read(benchmark::State& state) {
  RunFile file(std::filesystem::temp_directory_path());
  write_records(file, random_bytes(spool_bytes));
  const RunExtent run = file.end_run();
  std::vector<std::byte> record(record_bytes);
  while (state.KeepRunning())
    for (RunReader reader(file, run, std::uint64_t{1} << 20); !reader.empty();) reader.read(record);
  count(state, spool_bytes / record_bytes, spool_bytes);
}
BENCHMARK(spool_read)->Unit(benchmark::kMillisecond);

struct NumberOrder {
  using Head = std::uint64_t;
  static bool less(Head a, Head b) { return a < b; }
};

// Numbers put in order in an eighth of the memory they take: items are numbers.
void external_sort(benchmark::State& state) {
  constexpr std::size_t numbers = std::size_t{1} << 19;
  while (state.KeepRunning()) {
    std::mt19937_64 random(1);
    ExternalSorter<NumberOrder> sorter(std::filesystem::temp_directory_path(), numbers);
    for (std::size_t i = 0; i < numbers; ++i) sorter.push(random());
    for (std::uint64_t number = 0; sorter.next(number);) benchmark::DoNotOptimize(number);
  }
  count(state, numbers, 8 * numbers);
}
BENCHMARK(external_sort)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace voxweld::bench
