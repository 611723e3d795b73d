// How names of artifacts spread over folders.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/config/settings.h"
#include "storage/support/hash.h"
#include "storage/types/box.h"

namespace voxweld {

std::string short_hex(Hash128 hash);  // 12 digits
// Whose work a folder of that name holds, "<stage>-<12 hexadecimal digits>"; nothing for others.
std::optional<Stage> stage_of_folder(const std::filesystem::path& folder);
// Where `voxweld extract` makes its file, in the work directory: "extract-<12 hexadecimal digits>".
std::filesystem::path extract_folder(const std::filesystem::path& work, Hash128 hash);
bool is_extract_folder(const std::filesystem::path& folder);
// "<x>-<y>-<z>" and a folder for it that keeps every folder small.
std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name);

}  // namespace voxweld
