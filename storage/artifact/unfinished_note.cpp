#include "storage/artifact/unfinished_note.h"

#include <algorithm>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> note_kind = {'u', 'n', 'f', 'i'};
constexpr std::uint32_t note_version = 2;
constexpr std::uint64_t config_section = 1, first_names_section = 2;
constexpr std::size_t note_section_bytes = std::size_t{1} << 20;

ArtifactReader open_note(const std::filesystem::path& path) {
  return ArtifactReader(path, note_kind, note_version);
}

}  // namespace

void write_unfinished_note(const std::filesystem::path& path, const UnfinishedHead& head,
                           FileNames& names) {
  ArtifactWriter note(path, {note_kind, note_version, head.key});
  note.section(config_section, as_bytes(head.config));
  std::string text;
  std::uint64_t section = first_names_section;
  const auto flush = [&] {
    note.section(section++, as_bytes(text));
    text.clear();
  };
  names.each([&](const std::string& name) {
    text.append(name).push_back('\0');
    if (text.size() >= note_section_bytes) flush();
  });
  flush();
  note.commit(Durability::fsync);
}

UnfinishedHead read_unfinished_head(const std::filesystem::path& path) {
  const ArtifactReader note = open_note(path);
  std::vector<char> config;
  note.read_array(config_section, config);
  return {note.key(), {config.begin(), config.end()}};
}

void each_unfinished(const std::filesystem::path& path,
                     const std::function<void(std::string_view)>& name) {
  const ArtifactReader reader = open_note(path);
  std::vector<char> text;
  for (const SectionRecord& section : reader.sections()) {
    if (section.name == config_section) continue;
    reader.read_array(section.name, text);
    for (auto begin = text.begin(); begin != text.end();) {
      const auto end = std::find(begin, text.end(), '\0');
      name({&*begin, static_cast<std::size_t>(end - begin)});
      begin = end == text.end() ? end : end + 1;
    }
  }
}

}  // namespace voxweld
