// A run of slices of an input that is not read by boxes, decoded once into a raw file of which any
// box can be read. Every process has its own, so that two copies of a task do not meet in it.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/spool/spool.h"
#include "storage/types/volume.h"

namespace voxweld {

struct SpoolRequest {
  std::shared_ptr<SampleSource> input;
  std::filesystem::path folder;  // where the spool goes
  Hash128 stamp;                 // of the input
  std::int64_t lo = 0, hi = 0;   // slices, half-open
};

// The samples, in the input's own coordinates, and what is removed when nobody reads them any more.
struct SpooledInput {
  std::shared_ptr<const SampleSource> samples;
  std::shared_ptr<void> files;
};

// Throws what spool_volume throws. Boxes outside the slices must not be asked for.
SpooledInput spool_slices(const SpoolRequest& request, const SpoolOptions& options);

// Those that processes left behind when they were killed. Precondition: nobody spools there.
void remove_spools(const std::filesystem::path& folder);

}  // namespace voxweld
