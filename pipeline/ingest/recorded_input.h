// What an input that is read slice by slice said of itself when its brick store was made, so that
// later stages need not open it: image stacks cost a process 120 MiB and thousands of file headers.
#pragma once

#include <filesystem>
#include <optional>

#include "storage/support/hash.h"
#include "storage/types/volume.h"

namespace voxweld {

// `parameters`: of ingest. Kept as the record of a spool (storage/spool) named "input".
void record_input(const std::filesystem::path& folder, Hash128 parameters, const VolumeInfo& info);

// Nothing when there is no record, when it is of other parameters, or when any of the files, or a
// folder they lie in, is not as it was (a new slice changes its folder).
std::optional<VolumeInfo> recorded_input(const std::filesystem::path& folder, Hash128 parameters);

}  // namespace voxweld
