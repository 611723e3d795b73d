#include "storage/spool/spool_record.h"

#include <array>
#include <cstring>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> kind = {'s', 'p', 'o', 'l'};
constexpr std::uint32_t version = 4;
enum Section : std::uint64_t { facts_section = 1, texts_section = 2, files_section = 3 };

struct SpoolFacts {
  Index3 size;
  Vec3 spacing, origin, first;
  std::array<Vec3, 3> direction;
  Hash128 data_hash;
  std::uint64_t type, access, largest_decode;
  double slope, intercept;
  std::uint64_t files, warnings;  // how many of each follow in the texts
};
static_assert(sizeof(SpoolFacts) == 21 * 8 + 16 + 7 * 8);
static_assert(std::is_trivially_copyable_v<SpoolFacts>);

void put_text(std::vector<std::byte>& out, const std::string& text) {
  const std::uint64_t length = text.size();
  const auto prefix = as_record(length);
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
  return {geometry.size,
          geometry.spacing,
          geometry.origin,
          geometry.first,
          geometry.direction,
          record.data_hash,
          static_cast<std::uint64_t>(record.info.type),
          static_cast<std::uint64_t>(record.info.access),
          record.info.largest_decode,
          record.info.scale.slope,
          record.info.scale.intercept,
          record.info.files.size(),
          record.info.warnings.size()};
}

void apply_facts(const SpoolFacts& facts, SpoolRecord& record) {
  VolumeGeometry& geometry = record.info.geometry;
  geometry.size = facts.size;
  geometry.spacing = facts.spacing;
  geometry.origin = facts.origin;
  geometry.first = facts.first;
  geometry.direction = facts.direction;
  record.data_hash = facts.data_hash;
  record.info.type = static_cast<SampleType>(facts.type);
  record.info.access = static_cast<Access>(facts.access);
  record.info.largest_decode = facts.largest_decode;
  record.info.scale = value_scale(facts.slope, facts.intercept);
}

}  // namespace

std::filesystem::path spool_record_path(const std::filesystem::path& path) {
  return path.string() + ".record";
}

void write_spool_record(const std::filesystem::path& path, const SpoolRecord& record) {
  const SpoolFacts facts = facts_of(record);
  std::vector<std::byte> texts;
  std::vector<FileState> files;
  put_text(texts, record.info.format);
  put_text(texts, record.info.geometry.unit);
  put_text(texts, record.info.geometry.space);
  for (const InputFile& file : record.info.files) {
    put_text(texts, file.path);
    files.push_back(file.state);
  }
  for (const std::string& warning : record.info.warnings) put_text(texts, warning);
  ArtifactWriter writer(spool_record_path(path), {kind, version, record.key});
  writer.section(facts_section, as_record(facts));
  writer.section(texts_section, texts);
  writer.section(files_section, as_section(files));
  writer.commit(Durability::fsync);
}

SpoolRecord read_spool_record(const std::filesystem::path& path) {
  const ArtifactReader artifact(spool_record_path(path), kind, version);
  const auto facts = artifact.read_array<SpoolFacts>(facts_section);
  const auto files = artifact.read_array<FileState>(files_section);
  const auto texts = artifact.read_array<std::byte>(texts_section);
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
  for (const FileState& file : files) record.info.files.push_back({text.next(), file});
  for (std::uint64_t i = 0; i < facts.front().warnings; ++i)
    record.info.warnings.push_back(text.next());
  return record;
}

}  // namespace voxweld
