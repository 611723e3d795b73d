// How many workers may be at work at once within the memory the user allows.
#pragma once

#include <cstdint>
#include <string>

namespace voxweld {

struct MemoryBudget {
  std::uint64_t total = 0;  // bytes this process may have resident: run.memory
};

// What one stage needs, in bytes, and the words to refuse with.
struct StageMemory {
  std::string stage;  // "build"
  // Needed however many threads run: the program itself, shared tables, readers.
  std::uint64_t base_bytes = 0;
  // The most that one unit takes. Units under way wait for each other where theirs do not fit
  // together (memory_pool.h).
  std::uint64_t per_unit_bytes = 0;
  std::string unit;    // "one brick (brick = 256)"
  std::string advice;  // "raise run.memory or lower work.brick"
  // What a worker keeps from one unit to the next.
  std::uint64_t per_worker_bytes = 0;
};

// The most threads, at most `wanted_threads`, whose workers fit the budget beside the largest unit;
// at least 1.
// Precondition: wanted_threads >= 1.
// Throws InputError naming the smallest run.memory that would do where not even one unit fits.
int threads_within(const MemoryBudget& budget, const StageMemory& need, int wanted_threads);

// Exact, as run.memory takes it: "64MiB", "3GiB", "1000000B".
std::string exact_bytes(std::uint64_t bytes);
// Rounded, for people: "3.4 GiB", "12.0 MiB", "512 B".
std::string readable_bytes(double bytes);

}  // namespace voxweld
