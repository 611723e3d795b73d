// Names of the files that an output directory has or may get while it is being written, when there
// is no manifest that says so. Kind "unfi", a container with these sections:
//   1          the config file of the run that writes
//   2, 3 ...   names relative to the directory, each followed by a zero byte, about a MiB a section
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "storage/support/file_names.h"
#include "storage/support/hash.h"

namespace voxweld {

inline constexpr const char* unfinished_name = "unfinished.files";

struct UnfinishedHead {
  Hash128 key;         // of what is planned
  std::string config;  // the file whose run writes; empty: not known
};

// names: asked for once, in bounded memory.
void write_unfinished_note(const std::filesystem::path& path, const UnfinishedHead& head,
                           FileNames& names);
// Throws DamagedArtifact when it fails its checks, StorageError when it cannot be read.
UnfinishedHead read_unfinished_head(const std::filesystem::path& path);
void each_unfinished(const std::filesystem::path& path,
                     const std::function<void(std::string_view)>& name);

}  // namespace voxweld
