// Names of the files that an output directory has or may get while it is being written, when there
// is no manifest that says so. Kind "unfi", a container with these sections:
//   1, 2 ...   names relative to the directory, each followed by a zero byte, about a MiB a section
#pragma once

#include <filesystem>
#include <functional>

#include "storage/support/file_names.h"
#include "storage/support/hash.h"

namespace voxweld {

inline constexpr const char* unfinished_name = "unfinished.files";

// names: asked for once, in bounded memory. key: of what is planned.
void write_unfinished_note(const std::filesystem::path& path, Hash128 key, FileNames& names);
// Throws DamagedArtifact when it fails its checks, StorageError when it cannot be read.
Hash128 read_unfinished_key(const std::filesystem::path& path);
void each_unfinished(const std::filesystem::path& path,
                     const std::function<void(std::string_view)>& name);

}  // namespace voxweld
