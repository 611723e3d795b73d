#include "pipeline/info/info.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/build/finer_build.h"
#include "pipeline/info/kinds.h"
#include "pipeline/neuroglancer/folder.h"
#include "pipeline/stage/file_layout.h"
#include "stages/encode/mesh_writers.h"
#include "storage/image/slice_files.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/report_file.h"
#include "storage/meshes/mesh_file.h"
#include "storage/spool/spool_record.h"
#include "storage/store/zarr_metadata.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

std::string known_kinds() {
  return "info knows volumes (" + reader_names() + "), meshes (" +
         endings_text(mesh_writers(), ", ") + ", .off), configs, and all that a run writes";
}

[[noreturn]] void unknown(const std::string& path, const std::string& why) {
  throw FormatError(fmt::format("{}: {}; {}", path, why, known_kinds()));
}

// The array's folder when the file is a chunk of a Zarr array: somewhere above lies its metadata.
fs::path array_above(const fs::path& path) {
  constexpr int most_levels = 5;  // c/z/y/x
  fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  for (int level = 0; level < most_levels && folder.has_filename(); ++level) {
    if (holds_zarr_array(folder)) return folder;
    folder = folder.parent_path();
  }
  return {};
}

bool is_zarr_chunk(const fs::path& path) {
  const std::string name = path.filename().string();
  return std::ranges::all_of(name, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

std::string temporary_of(const fs::path& path) {
  const std::string name = path.filename().string();
  const auto at = name.find(".tmp-");
  return at == std::string::npos || at == 0 ? std::string() : name.substr(0, at);
}

// Names under which a run leaves artifacts: such a file without an artifact's header is damaged.
bool named_as_artifact(const fs::path& path) {
  for (const char* ending : {".octree", ".tile", ".record", ".shard", ".labels"})
    if (path.extension() == ending) return true;
  for (const char* name : {"top.tree", "histogram", "labels.all"})
    if (path.filename() == name) return true;
  return false;
}

InfoDocument describe_array(const fs::path& array, const InfoOptions& options) {
  InfoOptions of_array = options;
  of_array.input.path = array.string();
  const bool store = !store_records(array).empty();
  return store ? describe_store(array, of_array) : describe_volume(of_array);
}

bool holds_images(const fs::path& path) {
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_regular_file() && has_image_name(entry.path())) return true;
  return false;
}

// Whether a reader is sure that the folder is its own: what it says then is all there is to say.
bool named_by_contents(const InputSpec& input) {
  const InputProbe probe = probe_input(input.path);
  return input.format != "auto" ||
         std::ranges::any_of(volume_readers(), [&](const VolumeReader& reader) {
           return reader.test(probe) == Match::contents;
         });
}

InfoDocument describe_directory(const fs::path& path, const InfoOptions& options) {
  if (fs::exists(path / manifest_name)) return describe_output(path / manifest_name, options);
  if (is_neuroglancer_export(path)) return describe_export(path, options);
  if (auto document = describe_viewer_folder(path)) return *document;
  if (holds_zarr_array(path)) return describe_array(path, options);
  if (is_stage_directory(path)) return describe_stage_directory(path, options);
  if (is_work_directory(path)) return describe_work_directory(path, options);
  if (!outputs_within(path).empty()) require_output(path);
  try {
    return describe_volume(options);
  } catch (const InputError& error) {
    if (holds_images(path) || named_by_contents(options.input))
      throw;  // meant as a stack: what is wrong with it is all there is to say
    unknown(path.string(),
            fmt::format("a directory of an unknown kind (as an image stack: {})", error.what()));
  }
}

InfoDocument describe_tolerance_note(const fs::path& path) {
  const auto tolerance = read_tolerance_note(path);
  if (!tolerance) throw DamagedArtifact(path.string(), "has no number");
  InfoDocument document = file_document("tolerance_note", path);
  document["tolerance"] = *tolerance;
  return document;
}

// Files that their name and place tell, but no contents.
std::optional<InfoDocument> describe_by_name(const fs::path& path, const InfoOptions& options) {
  const std::string name = path.filename().string(), extension = path.extension().string();
  // Of the formats that others write too, what is said of an input serves both.
  if (options.input.format == "auto" && is_mesh_name(path)) return describe_input_mesh(options);
  if (writer_of_file(mesh_writers(), name) != nullptr) return describe_mesh(path);
  if (name == manifest_name) return describe_output(path, options);
  if (is_report(path)) return file_document("report", path);
  if (name == info_name)
    if (const fs::path folder = fs::absolute(path).parent_path(); is_neuroglancer_export(folder))
      return describe_export(folder, options);
  if (name == tiles_name || name == levels_name) return describe_tile_list(path, options);
  if (name == labels_name) return describe_label_list(path, options);
  if (name == tolerance_note_name &&
      stage_of_folder(fs::absolute(path).parent_path()) == Stage::build)
    return describe_tolerance_note(path);
  if (name == pieces_name) return file_document("pieces", path);
  if (extension == ".toml") return describe_config(path);
  if (fs::exists(spool_record_path(path))) return describe_spool(path, options);
  if (name == "zarr.json" || name == ".zarray") return describe_array(array_above(path), options);
  if (is_zarr_chunk(path)) {
    if (const fs::path array = array_above(path); !array.empty()) {
      InfoDocument document = file_document("zarr_chunk", path);
      document["array"] = array.string();
      return document;
    }
  }
  return std::nullopt;
}

bool some_reader_knows(const InputSpec& input) {
  if (input.format != "auto" || (input.raw.size && input.raw.type)) return true;
  const InputProbe probe = probe_input(input.path);
  return std::ranges::any_of(volume_readers(), [&](const VolumeReader& reader) {
    return reader.test(probe) != Match::none;
  });
}

InfoDocument describe_file(const fs::path& path, const InfoOptions& options) {
  if (const std::string of = temporary_of(path); !of.empty()) {
    InfoDocument document = file_document("temporary", path);
    document["of"] = of;
    return document;
  }
  if (const auto head = artifact_head(path)) return describe_artifact(path, *head, options);
  if (named_as_artifact(path))
    throw DamagedArtifact(path.string(),
                          "has no artifact's header: truncated, or not written by voxweld");
  if (const auto document = describe_by_name(path, options)) return *document;
  if (some_reader_knows(options.input)) return describe_volume(options);
  unknown(path.string(), "a file of an unknown kind");
}

}  // namespace

InfoDocument describe(const InfoOptions& options) {
  const std::string& path = options.input.path;
  try {
    if (is_url(path)) return describe_volume(options);
    if (fs::is_directory(path)) return describe_directory(path, options);
    if (fs::exists(path)) return describe_file(path, options);
    if (path.find_first_of("*?[") != std::string::npos) return describe_volume(options);
  } catch (const DamagedArtifact& damage) {
    throw FormatError(std::string(damage.what()) +
                      "; remove the file and run again: what is missing is made anew");
  } catch (const fs::filesystem_error& error) {
    const std::error_code code = error.code();
    for (const auto users : {std::errc::too_many_symbolic_link_levels, std::errc::permission_denied,
                             std::errc::not_a_directory, std::errc::filename_too_long})
      if (code == users)
        throw InputError(fmt::format("{}: {}; correct the path", path, code.message()));
    throw StorageError(fmt::format("{}: {}", path, code.message()), code.value());
  }
  throw InputError(path + ": no such file or directory; correct the path");
}

bool found_damage(const InfoDocument& document) {
  return document.contains("check") && !document["check"]["damaged"].empty();
}

}  // namespace voxweld
