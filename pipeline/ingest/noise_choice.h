// The level of noise where the config leaves it to the volume.
#pragma once

#include "pipeline/config/config.h"
#include "pipeline/ingest/ingest_stage.h"

namespace voxweld {

// Whether the surface is one whose estimate depends on it: surface.gradient = "auto".
bool asks_for_noise(const Config& config);
// Whether it has been measured, of the input as it is.
// Precondition of this and the next: the isovalue is resolved.
bool noise_is_known(const Config& config, const IngestJob& job);

// Of the samples as stored, around the surface. Reads a few samples of the volume, the same for the
// same volume, and keeps what comes out in ingest's folder for the next time.
// Precondition: ingest is current.
double choose_noise(const Config& config, const IngestJob& job);

struct VolumeNoise {
  double level = 0;         // standard deviation of the samples as stored
  std::int64_t places = 0;  // where they were looked at, a side of the volume
};
// What choose_noise finds where nothing is kept.
VolumeNoise measure_noise(const SampleSource& source, const Isovalue& stored_isovalue);

}  // namespace voxweld
