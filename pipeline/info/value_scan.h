// One pass over any source, whatever access it allows, a piece at a time: chunk by chunk where it has
// chunks, else bands of whole rows in rising order.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "pipeline/executor/interrupt.h"
#include "pipeline/ingest/volume_scan.h"

namespace voxweld {

struct ScanHooks {
  const InterruptFlag* interrupt = nullptr;
  std::function<void(double share)> progress;  // may be empty
  // Given all samples, a piece at a time; may be empty.
  std::function<void(const Box3& piece, std::span<const std::byte>)> samples;
};

// Histogram and range of all samples. Memory: one piece (8 MiB at most, or one slice of a
// stream, or one chunk), and what the source holds. Throws what source.read throws; Interrupted.
ScanResult scan_in_order(const SampleSource& source, const ScanHooks& hooks);

}  // namespace voxweld
