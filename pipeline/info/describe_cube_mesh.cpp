// What stitch, refine and seams leave of a mesh that is refined, and the plan of its tiles.
#include "pipeline/info/kinds.h"
#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/tile_plan_artifact.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

InfoDocument box_facts(const LatticeBox& box) {
  return {{"lo", box.lo}, {"hi", box.hi}};
}

InfoDocument refine_facts(const RefineCounts& counts) {
  return {{"cubes", counts.cubes},
          {"collapses", counts.collapses},
          {"moves", counts.moves},
          {"flips", counts.flips},
          {"intersecting_before", counts.pairs_before},
          {"intersecting_left", counts.pairs_left},
          {"worst_steps", counts.worst}};
}

}  // namespace

InfoDocument tile_list_facts(const std::vector<PlannedTile>& tiles) {
  InfoDocument list = InfoDocument::array();
  for (const PlannedTile& tile : tiles)
    list.push_back({{"level", tile.level},
                    {"at", facts_of(tile.key().at)},
                    {"vertices", tile.vertices},
                    {"polygons", tile.polygons}});
  return list;
}

InfoDocument describe_cube_mesh(const fs::path& path, const InfoOptions& options) {
  const CubeMeshArtifact artifact(path);
  const CubeMeshSummary& summary = artifact.summary();
  InfoDocument document = artifact_document("cube_mesh", path, artifact, cube_mesh_version);
  document["cubes"] = summary.pieces;
  document["vertices"] = summary.all.vertices;
  document["triangles"] = summary.all.triangles;
  document["leaving_triangles"] = summary.leaving;
  document["samples"] = summary.all.samples;
  if (summary.all.triangles > 0) document["box"] = box_facts(summary.box);
  document["refined"] = refine_facts(artifact.counted<RefineCounts>());
  if (!options.verbose) return document;
  document["cube_list"] = InfoDocument::array();
  for (const CubePieceRecord& piece : artifact.pieces())
    document["cube_list"].push_back({{"at", facts_of(morton_decode(piece.cube))},
                                     {"triangles", piece.inside.triangles},
                                     {"leaving_triangles", piece.leaving.triangles},
                                     {"samples", piece.inside.samples + piece.leaving.samples}});
  return document;
}

InfoDocument describe_tile_plan(const fs::path& path, const InfoOptions& options) {
  const TilePlanArtifact artifact(path);
  const TilePlanParts parts = artifact.read();
  InfoDocument document = artifact_document("tile_plan", path, artifact, tile_plan_version);
  document["tiles"] = parts.tiles.size();
  document["made_of"] = parts.sources.size();
  if (options.verbose) document["tile_list"] = tile_list_facts(parts.tiles);
  return document;
}

}  // namespace voxweld
