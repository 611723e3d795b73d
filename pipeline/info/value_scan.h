// One pass over any source, whatever access it allows: in rising z, a band at a time.
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
  // Given all samples, a band at a time; may be empty.
  std::function<void(const Box3& band, std::span<const std::byte>)> samples;
};

// Histogram and range of all samples. Memory: one band, at most 8 MiB or one slice of a stream,
// and what the source holds. Throws what source.read throws; Interrupted.
ScanResult scan_in_order(const SampleSource& source, const ScanHooks& hooks);

}  // namespace voxweld
