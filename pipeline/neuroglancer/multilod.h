// The second half of an export: fragments written in the multi-resolution or the old format.
#pragma once

#include <filesystem>

#include "pipeline/neuroglancer/fragment_sort.h"
#include "pipeline/neuroglancer/neuroglancer.h"
#include "pipeline/neuroglancer/object_store.h"

namespace voxweld {

struct FragmentWork {
  const Manifest& manifest;
  const SegmentList& list;
  int levels = 1;
  int threads = 1;
  const InterruptFlag* interrupt = nullptr;
};

// Adds to the totals.
void write_multilod(FragmentSort& sort, const FragmentWork& work, ObjectStore& store,
                    NeuroglancerTotals& totals);
// `<id>:0`, which names the fragments, and those: `<id>:0:0` ...
void write_legacy(FragmentSort& sort, const FragmentWork& work, const std::filesystem::path& folder,
                  NeuroglancerTotals& totals);

}  // namespace voxweld
