#include "pipeline/encode/output_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/stage/level_tree.h"
#include "stages/encode/mesh_writers.h"
#include "storage/artifact/unfinished_note.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/report_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash_file.h"

namespace voxweld {
namespace {

// Of digits and dashes, as a cube's name is, and then the ending.
bool is_of_cube(std::string_view file, std::string_view ending) {
  return file.ends_with(ending) &&
         file.find_first_not_of("0123456789-") >= file.size() - ending.size();
}

bool is_nested_tileset(const std::string& name) {
  const std::filesystem::path path = name;
  return path.begin()->string() == levels_folder && is_of_cube(path.filename().string(), ".json");
}

// Whether a run gives a file such a name that its manifest lists.
bool is_beside_manifest(const std::string& name) {
  return name == tiles_name || name == labels_name || name == levels_name || name == tileset_name ||
         name == pieces_name || is_nested_tileset(name) ||
         std::ranges::any_of(mesh_writers(), [&](const MeshWriter& writer) {
           return name == "mesh" + std::string(writer.ending);
         });
}

// Whether the lists are as they were written: what a damaged one names may be anything.
bool add_listed(const std::filesystem::path& output, FileNames& names) {
  const Manifest manifest = read_manifest(output / manifest_name);
  bool sound = true;
  for (const FileRecord& file : manifest.files) {
    names.add(file.path);
    sound = sound && is_beside_manifest(file.path);
  }
  for (const char* name : {tiles_name, levels_name}) {
    const auto list = std::ranges::find(manifest.files, name, &FileRecord::path);
    if (list == manifest.files.end() && name != tiles_name) continue;
    if (list == manifest.files.end() || !std::filesystem::exists(output / name) ||
        to_hex(hash_file(ReadFile(output / name))) != list->xxh3_128)
      return false;
    TileListReader tiles(output / name);
    while (const auto tile = tiles.next())
      for (const FileRecord& file : tile->files) names.add(file.path);
  }
  return sound;
}

std::filesystem::path note_path(const std::filesystem::path& output) {
  return output / unfinished_name;
}

// Whether the note is as it was written, or there is none.
bool add_noted(const std::filesystem::path& output, FileNames& names) {
  if (!std::filesystem::exists(note_path(output))) return true;
  try {
    each_unfinished(note_path(output), [&](std::string_view name) { names.add(name); });
  } catch (const DamagedArtifact&) {
    return false;
  }
  return true;
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

void each_of_our_form(const std::filesystem::path& output,
                      const std::function<void(const std::string&)>& f) {
  const auto offer = [&](const std::string& name) {
    if (std::filesystem::exists(output / name)) f(name);
  };
  for (const MeshWriter& writer : mesh_writers()) offer("mesh" + std::string(writer.ending));
  offer(tiles_name);
  for (const char* name : {labels_name, levels_name, tileset_name, pieces_name}) offer(name);
  for (const char* folder : {"tiles", "labels", levels_folder}) {
    if (!std::filesystem::is_directory(output / folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(output / folder)) {
      const std::string file = entry.path().filename().string();
      const MeshWriter* const writer = writer_of_file(mesh_writers(), file);
      const bool nested = std::string_view(folder) == levels_folder && is_of_cube(file, ".json");
      if (nested || (writer != nullptr && is_of_cube(file, writer->ending)))
        f(entry.path().lexically_relative(output).generic_string());
    }
  }
}

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
  bool all_listed = true;
  try {
    if (std::filesystem::exists(output / manifest_name)) all_listed = add_listed(output, names);
  } catch (const FormatError&) {
    all_listed = !is_of_voxweld(output / manifest_name);
  } catch (const StorageError&) {  // another task has just taken it away, after noting its names
    if (std::filesystem::exists(output / manifest_name)) throw;
  }
  const bool all_noted = add_noted(output, names);
  if (!all_listed || !all_noted || !has_run(output))
    each_of_our_form(output, [&](const std::string& name) { names.add(name); });
}

void begin_output(const std::filesystem::path& output, const UnfinishedHead& head, FileNames& names,
                  const std::function<void(FileNames&)>& planned) {
  add_files_of_earlier_runs(output, names);
  planned(names);
  write_unfinished_note(note_path(output), head, names);
  if (is_report(output / report_name)) remove_file(output / report_name);
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
