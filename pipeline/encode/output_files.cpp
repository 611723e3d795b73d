#include "pipeline/encode/output_files.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

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

void add_noted(const std::filesystem::path& output, FileNames& names) {
  if (!std::filesystem::exists(note_path(output))) return;
  try {
    each_unfinished(note_path(output), [&](std::string_view name) { names.add(name); });
  } catch (const DamagedArtifact&) {
    return;  // what it named stays; nothing else depends on it
  }
}

// The config whose run wrote what the directory holds; empty where that is not told.
std::filesystem::path owner_of(const std::filesystem::path& output) {
  const std::filesystem::path manifest = output / manifest_name;
  if (std::filesystem::exists(manifest)) {
    const Manifest made = read_manifest(manifest);
    if (made.config == nullptr || !made.config->contains("path")) return {};
    return made.config->at("path").get<std::string>();
  }
  if (!std::filesystem::exists(note_path(output))) return {};
  try {
    return read_unfinished_head(note_path(output)).config;
  } catch (const DamagedArtifact&) {
    return {};
  }
}

// A manifest of ours that is damaged has at least its name in it, or is cut short before that.
bool is_of_voxweld(const std::filesystem::path& manifest) {
  const std::string text = read_text_file(manifest);
  constexpr std::string_view begins = "{\n  \"format\": \"voxweld";
  return begins.starts_with(text) || text.find("voxweld") != std::string::npos;
}

}  // namespace

bool has_begun(const std::filesystem::path& output, Hash128 key) {
  if (std::filesystem::exists(output / manifest_name) ||
      !std::filesystem::exists(note_path(output)))
    return false;
  try {
    return read_unfinished_head(note_path(output)).key == key;
  } catch (const DamagedArtifact&) {
    return false;
  } catch (const StorageError&) {  // a task that ended the run has just taken it away
    return false;
  }
}

void check_owner(const std::filesystem::path& output, const std::filesystem::path& config) {
  if (config.empty()) return;
  std::filesystem::path owner;
  try {
    owner = owner_of(output);
  } catch (const FormatError& error) {
    if (is_of_voxweld(output / manifest_name)) return;
    throw InputError(fmt::format(
        "output.directory = \"{}\": has a {} that no run of voxweld wrote ({}); choose another "
        "directory, or give --force to write over it",
        output.string(), manifest_name, error.what()));
  }
  std::error_code gone;
  if (owner.empty() || owner == config || !std::filesystem::exists(owner, gone)) return;
  if (std::filesystem::equivalent(owner, config, gone)) return;
  throw InputError(
      fmt::format("output.directory = \"{}\": holds the meshes of {}; choose another directory, or "
                  "give --force to replace them",
                  output.string(), owner.string()));
}

bool has_run(const std::filesystem::path& output) {
  return std::filesystem::exists(output / manifest_name) ||
         std::filesystem::exists(note_path(output));
}

void add_files_of_earlier_runs(const std::filesystem::path& output, FileNames& names) {
  try {
    if (std::filesystem::exists(output / manifest_name)) add_listed(output, names);
  } catch (const FormatError&) {   // what it names beyond that stays
  } catch (const StorageError&) {  // another task has just taken it away, after noting its names
    if (std::filesystem::exists(output / manifest_name)) throw;
  }
  add_noted(output, names);
}

void begin_output(const std::filesystem::path& output, const UnfinishedHead& head, FileNames& names,
                  const std::function<void(FileNames&)>& planned) {
  add_files_of_earlier_runs(output, names);
  planned(names);
  write_unfinished_note(note_path(output), head, names);
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
