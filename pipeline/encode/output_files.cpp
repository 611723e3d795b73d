#include "pipeline/encode/output_files.h"

#include "storage/artifact/unfinished_note.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

void add_listed(const std::filesystem::path& output, FileNames& names) {
  for (const FileRecord& file : read_manifest(output / manifest_name).files) names.add(file.path);
  if (!std::filesystem::exists(output / tiles_name)) return;
  TileListReader tiles(output / tiles_name);
  while (const auto tile = tiles.next())
    for (const FileRecord& file : tile->files) names.add(file.path);
}

std::filesystem::path note_path(const std::filesystem::path& output) {
  return output / unfinished_name;
}

bool has_begun(const std::filesystem::path& output, Hash128 key) {
  if (std::filesystem::exists(output / manifest_name) ||
      !std::filesystem::exists(note_path(output)))
    return false;
  try {
    return read_unfinished_key(note_path(output)) == key;
  } catch (const DamagedArtifact&) {
    return false;
  } catch (const StorageError&) {  // a task that ended the run has just taken it away
    return false;
  }
}

void add_noted(const std::filesystem::path& output, FileNames& names) {
  if (!std::filesystem::exists(note_path(output))) return;
  try {
    each_unfinished(note_path(output), [&](std::string_view name) { names.add(name); });
  } catch (const DamagedArtifact&) {
    return;  // what it named stays; nothing else depends on it
  }
}

}  // namespace

void add_files_of_earlier_runs(const std::filesystem::path& output, FileNames& names) {
  try {
    if (std::filesystem::exists(output / manifest_name)) add_listed(output, names);
  } catch (const FormatError&) {   // what it names beyond that stays
  } catch (const StorageError&) {  // another task has just taken it away, after noting its names
    if (std::filesystem::exists(output / manifest_name)) throw;
  }
  add_noted(output, names);
}

void begin_output(const std::filesystem::path& output, Hash128 key, FileNames& names,
                  const std::function<void(FileNames&)>& planned) {
  if (has_begun(output, key)) return;
  add_files_of_earlier_runs(output, names);
  planned(names);
  write_unfinished_note(note_path(output), key, names);
  std::filesystem::remove(output / manifest_name);
}

void finish_output(const std::filesystem::path& output) {
  std::filesystem::remove(note_path(output));
}

bool output_is_finished(const std::filesystem::path& output) {
  if (!std::filesystem::exists(output / manifest_name) ||
      !std::filesystem::exists(output / tiles_name) || std::filesystem::exists(note_path(output)))
    return false;
  try {
    const Manifest manifest = read_manifest(output / manifest_name);
    return manifest.labels == LabelMode::off || std::filesystem::exists(output / labels_name);
  } catch (const FormatError&) {
    return false;
  }
}

}  // namespace voxweld
