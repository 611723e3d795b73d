// The describers, one for each kind of thing; info.cpp chooses.
#pragma once

#include <filesystem>

#include "pipeline/config/config.h"
#include "pipeline/info/facts.h"
#include "storage/artifact/container.h"
#include "storage/artifact/material_top.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

// Volumes and stores.
InfoDocument describe_volume(const InfoOptions& options);
// Where the records of a brick store lie; empty where the array is none of ours.
std::filesystem::path store_records(const std::filesystem::path& array);
InfoDocument describe_store(const std::filesystem::path& array, const InfoOptions& options);
InfoDocument describe_shard_record(const std::filesystem::path& path, const InfoOptions& options);
InfoDocument describe_spool(const std::filesystem::path& samples, const InfoOptions& options);

// Artifacts of the stages.
InfoDocument describe_artifact(const std::filesystem::path& path, const ArtifactHead& head,
                               const InfoOptions& options);

// What documents of artifacts begin with.
template <class Artifact>
InfoDocument artifact_document(const std::string& kind, const std::filesystem::path& path,
                               const Artifact& artifact, std::uint32_t version) {
  InfoDocument document = keyed_document(kind, path, artifact.key());
  document["content_hash"] = to_hex(artifact.content_hash());
  document["version"] = version;
  document["made_by"] = InfoDocument::parse(artifact.provenance(), nullptr, false);
  return document;
}

// Of the tables that merge and retile plan by.
void add_plan(InfoDocument& document, const MaterialTop& top, bool verbose);
// Of labels.mode = "each", in place of what there is without labels.
void add_label_tiles(InfoDocument& document, const TileArtifact& artifact);
InfoDocument describe_label_list(const std::filesystem::path& path, const InfoOptions& options);

// Of a mesh that is refined.
InfoDocument describe_cube_mesh(const std::filesystem::path& path, const InfoOptions& options);
InfoDocument describe_collapse_survey(const std::filesystem::path& path,
                                      const InfoOptions& options);
InfoDocument describe_tolerance(const std::filesystem::path& path);
InfoDocument describe_tile_plan(const std::filesystem::path& path, const InfoOptions& options);

// Of a mesh as the input that is read by pieces: kinds "mesh", "mbin" and "mtab".
InfoDocument describe_mesh_pieces(const std::filesystem::path& path, const std::string& kind);

// Meshes and what lists them.
InfoDocument describe_mesh(const std::filesystem::path& path);
InfoDocument describe_input_mesh(const InfoOptions& options);
InfoDocument describe_output(const std::filesystem::path& manifest, const InfoOptions& options);
InfoDocument describe_tile_list(const std::filesystem::path& path, const InfoOptions& options);

// A folder that `voxweld export --neuroglancer` has finished.
bool is_neuroglancer_export(const std::filesystem::path& folder);
InfoDocument describe_export(const std::filesystem::path& folder, const InfoOptions& options);
// What `voxweld view --export` has written; nothing where the folder is something else.
std::optional<InfoDocument> describe_viewer_folder(const std::filesystem::path& folder);

// Work directories and the small files in them.
bool is_work_directory(const std::filesystem::path& path);
bool is_stage_directory(const std::filesystem::path& path);
InfoDocument describe_work_directory(const std::filesystem::path& path, const InfoOptions& options);
InfoDocument describe_stage_directory(const std::filesystem::path& path,
                                      const InfoOptions& options);
InfoDocument describe_config(const std::filesystem::path& path);
// All settings that have a value by table and key; of lists of tables an array each.
InfoDocument settings_facts(const Config& config);

}  // namespace voxweld
