// What stitch, refine, seams, mend and remend leave of meshes that are refined, how far they went where that is
// chosen, and the plan of their tiles.
#include "pipeline/info/kinds.h"
#include "stages/refine/refine_range.h"
#include "storage/artifact/collapse_survey_artifact.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/tile_plan_artifact.h"
#include "storage/artifact/tolerance_artifact.h"

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

// How many different ones; pieces ascend by label.
std::uint64_t label_count(std::span<const CubePieceRecord> pieces) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    count += i == 0 || pieces[i].label != pieces[i - 1].label ? 1 : 0;
  return count;
}

std::uint64_t removed_count(std::span<const CubePieceRecord> pieces) {
  std::uint64_t count = 0;
  for (const CubePieceRecord& piece : pieces) count += piece.removed;
  return count;
}

}  // namespace

InfoDocument describe_cube_mesh(const fs::path& path, const InfoOptions& options) {
  const CubeMeshArtifact artifact(path);
  const CubeMeshSummary& summary = artifact.summary();
  InfoDocument document = artifact_document("cube_mesh", path, artifact, cube_mesh_version);
  // Label 0 may be a label, or stand for one surface.
  document["labels"] = label_count(artifact.pieces());
  document["pieces"] = summary.pieces;
  document["vertices"] = summary.all.vertices;
  document["triangles"] = summary.all.triangles;
  document["leaving_triangles"] = summary.leaving;
  // Of a patch, of what was there before.
  document["removed_triangles"] = removed_count(artifact.pieces());
  document["samples"] = summary.all.samples;
  if (summary.all.triangles > 0) document["box"] = box_facts(summary.box);
  document["refined"] = refine_facts(artifact.counted<RefineCounts>());
  if (!options.verbose) return document;
  document["cube_list"] = InfoDocument::array();
  for (const CubePieceRecord& piece : artifact.pieces())
    document["cube_list"].push_back({{"label", piece.label},
                                     {"at", facts_of(morton_decode(piece.cube))},
                                     {"triangles", piece.inside.triangles},
                                     {"leaving_triangles", piece.leaving.triangles},
                                     {"removed_triangles", piece.removed},
                                     {"boxes", piece.holes},
                                     {"samples", piece.inside.samples + piece.leaving.samples}});
  return document;
}

InfoDocument describe_collapse_survey(const fs::path& path, const InfoOptions& options) {
  const CollapseSurveyArtifact artifact = read_collapse_survey(path);
  const CollapseSurvey& survey = artifact.survey;
  InfoDocument document = keyed_document("collapse_survey", path, artifact.key);
  document["content_hash"] = to_hex(artifact.content);
  document["triangles"] = survey.all();
  document["fixed_triangles"] = survey.fixed;
  document["held_triangles"] = survey.held;
  document["border_vertices"] = survey.border;
  document["tolerances"] = survey.left.size();
  if (!options.verbose) return document;
  document["triangles_left"] = survey.left;
  return document;
}

InfoDocument describe_tolerance(const fs::path& path) {
  const ToleranceArtifact artifact = read_tolerance_artifact(path);
  InfoDocument document = keyed_document("tolerance", path, artifact.key);
  document["tolerance_steps"] = artifact.chosen.tolerance;
  document["triangles_before"] = artifact.chosen.before;
  document["triangles_asked_for"] = artifact.chosen.target;
  document["triangles_about"] = artifact.chosen.left;
  document["reached"] = artifact.chosen.reached != 0;
  return document;
}

InfoDocument describe_tile_plan(const fs::path& path, const InfoOptions& options) {
  const TilePlanArtifact artifact(path);
  InfoDocument document = artifact_document("tile_plan", path, artifact, tile_plan_version);
  document["made_of"] = artifact.sources().size();
  add_plan(document, MaterialTop(artifact.file()), options.verbose);
  return document;
}

}  // namespace voxweld
