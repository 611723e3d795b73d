// The volume as the stages see it, and how the config cuts it up.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "pipeline/config/config.h"
#include "stages/contouring/brick_grid.h"
#include "storage/support/hash.h"
#include "storage/types/output_lattice.h"
#include "storage/types/solid.h"
#include "storage/types/volume.h"

namespace voxweld {

// The volume as the stages read it: by boxes, from any thread.
struct Volume {
  std::shared_ptr<const SampleSource> source;
  // Of what the samples of a box come from: equal when nothing hints at a change there (names,
  // sizes and times of files, hashes of a store's shards).
  std::function<Hash128(const Box3& samples)> stamp;
  // A mesh as the input: it comes before all edits, in the frame spacing * sample index.
  std::optional<Solid> solid = {};

  const VolumeGeometry& geometry() const { return source->info().geometry; }
  const RangedSource* ranges() const { return source->ranges(); }
};

BrickGrid brick_grid(const Config& config, const VolumeGeometry& geometry);
double smallest_spacing(const VolumeGeometry& geometry);

// That of the files: as it is where floats hold its coordinates on this lattice; else, of what is
// far from 0, such that the first sample is at 0 and the rest is left to `origin`.
VolumeGeometry output_geometry(const VolumeGeometry& geometry, const OutputLattice& lattice);

}  // namespace voxweld
