// A finished output directory as meshes for Neuroglancer, in a folder of "precomputed" format.
//
// Based on: google/neuroglancer, src/datasource/precomputed/meshes.md, sharded.md and
// segment_properties.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

struct NeuroglancerOptions {
  // The old format: one level of detail, positions as floats in nanometres, not compressed.
  bool legacy = false;
  bool sharded = false;  // files of many objects; not of the old format
  bool force = false;    // over an earlier export
  int threads = 0;       // 0: all there are
  // Fragments are made so large that they are expected to have about so many triangles.
  std::uint64_t fragment_triangles = 60000;
  const InterruptFlag* interrupt = nullptr;
};

struct NeuroglancerTotals {
  std::uint64_t objects = 0, fragments = 0, triangles = 0, bytes = 0, files = 0;
  int levels = 1;
  bool left_out_zero = false;  // label 0, which is no segment there
  bool no_unit = false;        // or none that is known
};

// `info` comes last: a folder without one is not finished. The same output directory gives the same bytes,
// on any number of threads. Memory: a tile and a fragment for each thread, and what FragmentSort holds; the
// rest is in a scratch file in the folder. InputError where the directory or the folder will not do,
// FormatError for a damaged tile.
NeuroglancerTotals write_neuroglancer(const std::filesystem::path& output,
                                      const std::filesystem::path& folder,
                                      const NeuroglancerOptions& options);

}  // namespace voxweld
