// What the programs share that measure what one process does at sizes nobody has at hand.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "pipeline/encode/listing.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/console.h"
#include "pipeline/executor/resources.h"
#include "pipeline/stage/context.h"

namespace voxweld {

// Small, fast and the same everywhere (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number
// Generators", 2014).
inline std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

// Wall time of f and the peak of the process so far.
template <class F>
void timed(const char* what, F&& f) {
  const StageMeter meter;
  f();
  const StageFigures figures = meter.read();
  fmt::print("{:<36} {:8.1f} s, {:6.1f} s of processor, peak {:6.1f} MiB\n", what, figures.wall_s,
             figures.cpu_s, static_cast<double>(figures.peak_resident) / 1048576);
  std::fflush(stdout);
}

inline RunContext quiet_context(Executor& executor) {
  RunContext context;
  context.executor = &executor;
  context.console = Console::standard_error();
  context.progress.enabled = false;
  return context;
}

// As encode ends: of a volume of so many samples a side.
inline void write_lists(const Listing& listing, const std::filesystem::path& scratch,
                        std::int64_t samples) {
  FileNames earlier(scratch);
  add_files_of_earlier_runs(listing.output, earlier);
  Manifest manifest;
  manifest.frame.size = {samples, samples, samples};
  write_listing(listing, earlier, std::move(manifest));
}

}  // namespace voxweld
