#include "storage/artifact/mesh_bin_artifact.h"

#include <algorithm>

namespace voxweld {
namespace {

constexpr std::uint64_t facts_section = 1, sides_section = 2;
constexpr std::uint64_t bricks_section = 1;
constexpr const char* no_facts = "has no facts";

static_assert(sizeof(MeshRecord) == 16 + 5 * 8 + 4 * 24);
static_assert(sizeof(MeshTableFacts) == 3 * 8 + 24 && sizeof(MeshSide) == 1);

std::uint64_t corners_section(std::uint64_t brick) {
  return 2 + 2 * brick;
}
std::uint64_t first_section(std::uint64_t brick) {
  return 3 + 2 * brick;
}

std::vector<MeshSide> read_sides(const ArtifactReader& file, std::uint64_t section) {
  std::vector<MeshSide> sides = file.read_array<MeshSide>(section);
  if (std::ranges::any_of(sides, [](MeshSide side) { return side > MeshSide::reached; }))
    file.damaged("has a side that is none");
  return sides;
}

void expect_key(const ArtifactReader& file, const std::optional<Hash128>& key) {
  if (key && file.key() != *key) file.damaged("is of another input or other parameters");
}

}  // namespace

void write_mesh_record(const std::filesystem::path& path, Hash128 key, const MeshRecord& record) {
  ArtifactWriter file(path, {mesh_record_kind, mesh_record_version, key});
  file.section(facts_section, as_record(record));
  file.commit();
}

MeshRecord read_mesh_record(const std::filesystem::path& path, std::optional<Hash128> key) {
  const ArtifactReader file(path, mesh_record_kind, mesh_record_version);
  expect_key(file, key);
  return file.read_record<MeshRecord>(facts_section, no_facts);
}

MeshBinsWriter::MeshBinsWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {mesh_bins_kind, mesh_bins_version, key}) {}

void MeshBinsWriter::bin(std::uint64_t brick, const MeshBin& bin) {
  file_.section(corners_section(brick), as_section(bin.corners));
  file_.section(first_section(brick), as_section(bin.first));
}

void MeshBinsWriter::commit(std::span<const MeshSide> bricks) {
  file_.section(bricks_section, std::as_bytes(bricks));
  file_.commit();
}

MeshBins::MeshBins(const std::filesystem::path& path)
    : OpenArtifact(path, mesh_bins_kind, mesh_bins_version),
      bricks_(read_sides(file_, bricks_section)) {}

std::uint64_t MeshBins::triangles(std::uint64_t brick) const {
  const SectionRecord* corners = file_.find(corners_section(brick));
  return corners == nullptr ? 0 : corners->size / (3 * sizeof(Index3));
}

MeshBin MeshBins::read(std::uint64_t brick, const Box3& samples) const {
  MeshBin bin;
  file_.read_array(corners_section(brick), bin.corners);
  file_.read_array(first_section(brick), bin.first);
  if (bin.corners.size() % 3 != 0 || bin.first.size() != row_words(samples))
    file_.damaged("a bin has another size than it should");
  return bin;
}

void write_mesh_table(const std::filesystem::path& path, Hash128 key, const MeshTable& table) {
  ArtifactWriter file(path, {mesh_table_kind, mesh_bins_version, key});
  file.section(facts_section, as_record(table.facts));
  file.section(sides_section, as_section(table.shards));
  file.commit();
}

MeshTable read_mesh_table(const std::filesystem::path& path, std::optional<Hash128> key) {
  const ArtifactReader file(path, mesh_table_kind, mesh_bins_version);
  expect_key(file, key);
  return {file.read_record<MeshTableFacts>(facts_section, no_facts),
          read_sides(file, sides_section)};
}

}  // namespace voxweld
