// Which files of an output directory are ours: those its manifest lists, and while encode is at
// work, when there is no manifest, those of its `unfinished.files`
// (storage/artifact/unfinished_note.h). So a run that follows a killed one
// still knows what to clear away.
#pragma once

#include <filesystem>
#include <functional>

#include "storage/support/file_names.h"
#include "storage/support/hash.h"

namespace voxweld {

// Adds what earlier runs wrote or were about to write. Somebody else's manifest lists nothing of
// ours.
void add_files_of_earlier_runs(const std::filesystem::path& output, FileNames& names);

// Before anything in the directory changes: notes for later runs the names of earlier ones and the
// `planned`, and takes the manifest away, which is about to stop being true. key: of what is
// planned; where a task of the same run has been before this one nothing is left to do, and
// `planned` is not asked for. names: empty; where they are put together.
void begin_output(const std::filesystem::path& output, Hash128 key, FileNames& names,
                  const std::function<void(FileNames&)>& planned);
// After the new manifest: the note has done its work.
void finish_output(const std::filesystem::path& output);
// Whether the manifest and the list of tiles are there and no run was cut short before they were.
bool output_is_finished(const std::filesystem::path& output);

}  // namespace voxweld
