// What an input that is read slice by slice said of itself when its brick store was made, so that
// later stages need not open it: image stacks cost a process 120 MiB and thousands of file headers.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/config/config.h"
#include "storage/support/hash.h"
#include "storage/types/volume.h"

namespace voxweld {

// What of the config it depends on.
Hash128 input_record_key(const Config& config);

// Kept as the record of a spool (storage/spool) named "input".
void record_input(const std::filesystem::path& folder, Hash128 key, const VolumeInfo& info);

// Nothing when there is no record, when it has another key, or when any of the files, or a
// folder they lie in, is not as it was (a new slice changes its folder).
std::optional<VolumeInfo> recorded_input(const std::filesystem::path& folder, Hash128 key);

}  // namespace voxweld
