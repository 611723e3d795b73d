#include "pipeline/encode/output_files.h"

#include <algorithm>

#include "storage/artifact/container.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> note_kind = {'u', 'n', 'f', 'i'};
constexpr std::uint32_t note_version = 1;
constexpr std::uint64_t first_section = 1;
constexpr std::size_t section_bytes = std::size_t{1} << 20;

void add_listed(const std::filesystem::path& output, FileNames& names) {
  for (const FileRecord& file : read_manifest(output / manifest_name).files) names.add(file.path);
  if (!std::filesystem::exists(output / tiles_name)) return;
  TileListReader tiles(output / tiles_name);
  while (const auto tile = tiles.next())
    for (const FileRecord& file : tile->files) names.add(file.path);
}

std::filesystem::path note_path(const std::filesystem::path& output) {
  return output / "unfinished.files";
}

bool has_begun(const std::filesystem::path& output, Hash128 key) {
  if (std::filesystem::exists(output / manifest_name) ||
      !std::filesystem::exists(note_path(output)))
    return false;
  try {
    return ArtifactReader(note_path(output), note_kind, note_version).key() == key;
  } catch (const DamagedArtifact&) {
    return false;
  } catch (const StorageError&) {  // a task that ended the run has just taken it away
    return false;
  }
}

void add_noted(const std::filesystem::path& output, FileNames& names) {
  if (!std::filesystem::exists(note_path(output))) return;
  try {
    const ArtifactReader reader(note_path(output), note_kind, note_version);
    std::vector<char> text;
    for (const SectionRecord& section : reader.sections()) {
      reader.read_array(section.name, text);
      for (auto begin = text.begin(); begin != text.end();) {
        const auto end = std::find(begin, text.end(), '\0');
        names.add({&*begin, static_cast<std::size_t>(end - begin)});
        begin = end == text.end() ? end : end + 1;
      }
    }
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
  ArtifactWriter note(note_path(output), {note_kind, note_version, key});
  std::string text;
  std::uint64_t section = first_section;
  const auto flush = [&] {
    note.section(section++, as_bytes(text));
    text.clear();
  };
  names.each([&](const std::string& name) {
    text.append(name).push_back('\0');
    if (text.size() >= section_bytes) flush();
  });
  flush();
  note.commit(Durability::fsync);
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
