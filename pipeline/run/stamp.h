// The stamp of a stage's folder: the state of the volume (paths, sizes, times) under which
// everything in it was last known to be right. While it is the volume's, contents need not be
// compared.
#pragma once

#include <filesystem>
#include <optional>

#include "storage/support/hash.h"

namespace voxweld {

std::optional<Hash128> read_stamp(
    const std::filesystem::path& folder);  // nothing when there is none
void write_stamp(const std::filesystem::path& folder, Hash128 stamp);

}  // namespace voxweld
