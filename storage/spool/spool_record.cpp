#include "storage/spool/spool_record.h"

#include <array>
#include <cstring>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> kind = {'s', 'p', 'o', 'l'};
constexpr std::uint32_t version = 2;
enum Section : std::uint64_t { facts_section = 1, texts_section = 2, files_section = 3 };

struct SpoolFacts {
  std::int64_t size[3];
  double spacing[3], origin[3], direction[3][3];
  Hash128 data_hash;
  std::uint64_t type, access, largest_decode;
  std::uint64_t files, warnings;  // how many of each follow in the texts
};
static_assert(sizeof(SpoolFacts) == 18 * 8 + 16 + 5 * 8);
static_assert(std::is_trivially_copyable_v<SpoolFacts>);

struct FileFacts {
  std::uint64_t size;
  std::int64_t mtime_ns;
};

void put_text(std::vector<std::byte>& out, const std::string& text) {
  const std::uint64_t length = text.size();
  const auto prefix = std::as_bytes(std::span(&length, 1));
  out.insert(out.end(), prefix.begin(), prefix.end());
  const auto characters = as_bytes(text);
  out.insert(out.end(), characters.begin(), characters.end());
}

class TextReader {
 public:
  TextReader(const ArtifactReader& artifact, std::span<const std::byte> data)
      : artifact_(artifact), data_(data) {}

  std::string next() {
    std::uint64_t length = 0;
    if (data_.size() < sizeof length) artifact_.damaged("its texts end too early");
    std::memcpy(&length, data_.data(), sizeof length);
    data_ = data_.subspan(sizeof length);
    if (data_.size() < length) artifact_.damaged("its texts end too early");
    std::string text(reinterpret_cast<const char*>(data_.data()), length);
    data_ = data_.subspan(length);
    return text;
  }

 private:
  const ArtifactReader& artifact_;
  std::span<const std::byte> data_;
};

SpoolFacts facts_of(const SpoolRecord& record) {
  const VolumeGeometry& geometry = record.info.geometry;
  SpoolFacts facts{};
  for (int axis = 0; axis < 3; ++axis) {
    facts.size[axis] = geometry.size[axis];
    facts.spacing[axis] = geometry.spacing[axis];
    facts.origin[axis] = geometry.origin[axis];
    for (int component = 0; component < 3; ++component)
      facts.direction[axis][component] =
          geometry.direction[static_cast<std::size_t>(axis)][component];
  }
  facts.data_hash = record.data_hash;
  facts.type = static_cast<std::uint64_t>(record.info.type);
  facts.access = static_cast<std::uint64_t>(record.info.access);
  facts.largest_decode = record.info.largest_decode;
  facts.files = record.info.files.size();
  facts.warnings = record.info.warnings.size();
  return facts;
}

void apply_facts(const SpoolFacts& facts, SpoolRecord& record) {
  VolumeGeometry& geometry = record.info.geometry;
  for (int axis = 0; axis < 3; ++axis) {
    geometry.size[axis] = facts.size[axis];
    geometry.spacing[axis] = facts.spacing[axis];
    geometry.origin[axis] = facts.origin[axis];
    for (int component = 0; component < 3; ++component)
      geometry.direction[static_cast<std::size_t>(axis)][component] =
          facts.direction[axis][component];
  }
  record.data_hash = facts.data_hash;
  record.info.type = static_cast<SampleType>(facts.type);
  record.info.access = static_cast<Access>(facts.access);
  record.info.largest_decode = facts.largest_decode;
}

}  // namespace

std::filesystem::path spool_record_path(const std::filesystem::path& path) {
  return path.string() + ".record";
}

void write_spool_record(const std::filesystem::path& path, const SpoolRecord& record) {
  const SpoolFacts facts = facts_of(record);
  std::vector<std::byte> texts;
  std::vector<FileFacts> files;
  put_text(texts, record.info.format);
  put_text(texts, record.info.geometry.unit);
  put_text(texts, record.info.geometry.space);
  for (const InputFile& file : record.info.files) {
    put_text(texts, file.path);
    files.push_back({file.size, file.mtime_ns});
  }
  for (const std::string& warning : record.info.warnings) put_text(texts, warning);
  ArtifactWriter writer(spool_record_path(path), {kind, version, record.key});
  writer.section(facts_section, std::as_bytes(std::span(&facts, 1)));
  writer.section(texts_section, texts);
  writer.section(files_section, std::as_bytes(std::span(files)));
  writer.commit(Durability::fsync);
}

SpoolRecord read_spool_record(const std::filesystem::path& path) {
  const ArtifactReader artifact(spool_record_path(path), kind, version);
  std::vector<SpoolFacts> facts;
  std::vector<FileFacts> files;
  std::vector<std::byte> texts;
  artifact.read_array(facts_section, facts);
  artifact.read_array(files_section, files);
  artifact.read(texts_section, texts);
  if (facts.size() != 1 || facts.front().files != files.size() ||
      facts.front().type > static_cast<std::uint64_t>(SampleType::f64) ||
      facts.front().access > static_cast<std::uint64_t>(Access::stream))
    artifact.damaged("its facts contradict each other");
  SpoolRecord record;
  record.key = artifact.key();
  apply_facts(facts.front(), record);
  TextReader text(artifact, texts);
  record.info.format = text.next();
  record.info.geometry.unit = text.next();
  record.info.geometry.space = text.next();
  for (const FileFacts& file : files)
    record.info.files.push_back({text.next(), file.size, file.mtime_ns});
  for (std::uint64_t i = 0; i < facts.front().warnings; ++i)
    record.info.warnings.push_back(text.next());
  return record;
}

}  // namespace voxweld
