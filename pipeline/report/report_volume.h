// The volume that the meshes of an output directory were made of, where it is still there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/report/volume_samples.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

struct VolumeLook {
  VolumeInfo info;
  SampleSurvey samples;
  std::vector<std::string> warnings;  // of its reader
};

// Why the volume cannot be shown, as a sentence: the input is none, is gone or has changed. Empty
// where nothing of that is known. Looks at the files that the manifest names, and reads nothing.
std::string why_no_volume(const Manifest& manifest, const Config& config);

// The volume as the surface was found in it: cropped and filtered. Samples come from the input
// itself or from its copy in the work directory. Throws where it cannot be opened or read.
// request.labels: set by what the config asks for.
VolumeLook look_at_volume(const Manifest& manifest, const Config& config, SampleRequest request);

}  // namespace voxweld
