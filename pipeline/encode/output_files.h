// Which files of an output directory are ours: those its manifest lists, and while encode is at
// work, when there is no manifest, those of its `unfinished.files`
// (storage/artifact/unfinished_note.h). So a run that follows a killed one
// still knows what to clear away. Where these are damaged or gone, all files of the names that runs
// give count as ours, once the run may write into the directory at all.
#pragma once

#include <filesystem>
#include <functional>

#include "storage/artifact/unfinished_note.h"
#include "storage/support/file_names.h"

namespace voxweld {

// Calls f with the names of those files in the directory that have the names of a run's.
void each_of_our_form(const std::filesystem::path& output,
                      const std::function<void(const std::string&)>& f);

// Adds what earlier runs wrote or were about to write. Somebody else's manifest lists nothing of
// ours.
void add_files_of_earlier_runs(const std::filesystem::path& output, FileNames& names);

// InputError where the directory is not for this config's runs to write: a manifest or note of
// another config that is still there is in it, or a manifest of something else.
// config: the config's own file; empty: not known, and nothing is refused.
void check_owner(const std::filesystem::path& output, const std::filesystem::path& config);

// Whether a manifest or a note says which of the directory's files are of a run.
bool has_run(const std::filesystem::path& output);

// Whether a task of the same run, which plans the same, has been at begin_output before this one.
bool has_begun(const std::filesystem::path& output, Hash128 key);
// Before anything in the directory changes: notes for later runs the names of earlier ones and the
// `planned`, and takes the manifest and the report away, which are about to stop being true. names:
// empty; where they are put together.
void begin_output(const std::filesystem::path& output, const UnfinishedHead& head, FileNames& names,
                  const std::function<void(FileNames&)>& planned);
// After the new manifest: the note has done its work.
void finish_output(const std::filesystem::path& output);
// Whether the manifest and the list of tiles are there and no run was cut short before they were.
bool output_is_finished(const std::filesystem::path& output);

}  // namespace voxweld
