// What ingest leaves of a mesh that does not fit memory.
#include "pipeline/info/kinds.h"
#include "storage/artifact/mesh_bin_artifact.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

InfoDocument side_facts(std::span<const MeshSide> sides) {
  std::array<std::uint64_t, 3> counts{};
  for (const MeshSide side : sides) ++counts[static_cast<std::size_t>(side)];
  return {{"outside", counts[0]}, {"inside", counts[1]}, {"reached", counts[2]}};
}

InfoDocument describe_record(const fs::path& path) {
  const ArtifactReader file(path, mesh_record_kind, mesh_record_version);
  const MeshRecord record = read_mesh_record(path);
  InfoDocument document = keyed_document("mesh_record", path, file.key());
  document["content_hash"] = to_hex(record.content);
  document["vertices"] = record.vertices;
  document["triangles"] = record.triangles;
  document["bounds"] = {{"lo", facts_of(record.lo)}, {"hi", facts_of(record.hi)}};
  return document;
}

InfoDocument describe_bins(const fs::path& path) {
  const MeshBins bins(path);
  InfoDocument document = keyed_document("mesh_bins", path, bins.key());
  std::uint64_t triangles = 0;
  for (std::uint64_t brick = 0; brick < bins.bricks().size(); ++brick)
    triangles += bins.triangles(brick);
  document["bricks"] = side_facts(bins.bricks());
  document["triangles"] = triangles;
  return document;
}

InfoDocument describe_table(const fs::path& path) {
  const ArtifactReader file(path, mesh_table_kind, mesh_bins_version);
  const MeshTable table = read_mesh_table(path);
  InfoDocument document = keyed_document("mesh_table", path, file.key());
  document["shards"] = side_facts(table.shards);
  document["bricks"] = table.facts.bricks;
  document["triangles"] = table.facts.triangles;
  document["largest"] = {{"brick", facts_of(table.facts.largest_brick)},
                         {"triangles", table.facts.largest}};
  return document;
}

}  // namespace

InfoDocument describe_mesh_pieces(const fs::path& path, const std::string& kind) {
  if (kind == "mesh") return describe_record(path);
  return kind == "mbin" ? describe_bins(path) : describe_table(path);
}

}  // namespace voxweld
