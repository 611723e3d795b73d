#include "pipeline/executor/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;

std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
  return a > std::numeric_limits<std::uint64_t>::max() - b
             ? std::numeric_limits<std::uint64_t>::max()
             : a + b;
}

}  // namespace

int threads_within(const MemoryBudget& budget, const StageMemory& need, int wanted_threads) {
  const std::uint64_t fixed = saturating_sum(need.base_bytes, need.per_unit_bytes);
  const std::uint64_t smallest = saturating_sum(fixed, need.per_worker_bytes);
  if (smallest > budget.total) {
    // Rounded up, so that the figure named is one that works.
    const std::uint64_t enough = smallest / mebibyte + (smallest % mebibyte != 0 ? 1 : 0);
    throw InputError(
        fmt::format("run.memory = {} is too small: stage {} needs at least {}MiB for {}; {}",
                    exact_bytes(budget.total), need.stage, enough, need.unit, need.advice));
  }
  const auto wanted = static_cast<std::uint64_t>(std::max(wanted_threads, 1));
  if (need.per_worker_bytes == 0) return static_cast<int>(wanted);
  return static_cast<int>(std::min(wanted, (budget.total - fixed) / need.per_worker_bytes));
}

std::string exact_bytes(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes != 0 && bytes % 1024 == 0 && unit + 1 < units.size()) {
    bytes /= 1024;
    ++unit;
  }
  return fmt::format("{}{}", bytes, units[unit]);
}

std::string readable_bytes(double bytes) {
  constexpr std::array<const char*, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= 1024 && unit + 1 < units.size()) {
    bytes /= 1024;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} B", bytes) : fmt::format("{:.1f} {}", bytes, units[unit]);
}

}  // namespace voxweld
