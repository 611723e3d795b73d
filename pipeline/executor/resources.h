// What a stage used of the machine: time, processor time and memory of this process.
#pragma once

#include <cstdint>

namespace voxweld {

struct StageFigures {
  double wall_s = 0;
  double cpu_s = 0;                 // of all threads of this process
  std::uint64_t peak_resident = 0;  // bytes
  // False where the system does not let the peak be reset: then it is the process's so far.
  bool peak_is_of_stage = false;
};

// Bytes this process has resident now; 0 where the system does not say.
std::uint64_t resident_bytes();

// Measures from its construction on. Stages run one after the other: a meter resets the peak that
// an older one still reads.
class StageMeter {
 public:
  StageMeter();
  StageFigures read() const;

 private:
  double wall_start_s_;
  double cpu_start_s_;
  bool peak_was_reset_;
};

// Makes freed memory go back to the system, so that what one stage held does not count against the
// next: large blocks are mapped and unmapped each by itself, and the number of arenas is bounded.
// Call once, before any thread starts. No effect but on glibc.
void tune_allocator(int threads);
// Lets the allocator keep some of what a unit has freed for the next, where there is room for it:
// pages that are mapped anew are filled with zeros first. Of `memory` bytes a 32nd at most lies free
// at the ends of the threads' arenas. For the start of a stage.
void keep_freed_memory(std::uint64_t memory, int threads);
// The size from which on a block is then mapped and unmapped by itself: 256 KiB to 4 MiB.
std::uint64_t mapped_block_bytes(std::uint64_t memory, int threads);
// Returns what lies free inside the allocator; for the gap between two stages.
void release_free_memory();

}  // namespace voxweld
