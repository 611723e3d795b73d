// Encode: tile meshes to compressed assets, the merged mesh where it fits, and the manifest.
#pragma once

#include "pipeline/encode/asset_work.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

// Whether the merged mesh is to be written, and in which formats: "auto" leaves out those that do not
// fit run.memory. Throws InputError where it is asked for and does not fit.
struct MergedPlan {
  bool write = false;
  MergedParts parts = MergedParts::all;
  std::uint64_t bytes = 0;  // what it takes in memory, beside the program
  std::string why_not;      // for the user, when auto leaves something out
};
// pair_bytes: what the pairs of its triangles take (labels.mode = "shared"), once stitch has found
// them.
MergedPlan plan_merged(const Config& config, const UnitPlan& units, std::uint64_t pair_bytes = 0);

// What encoding a tile of that size takes.
std::uint64_t encode_bytes(const Config& config, const PlannedTile& tile, bool of_pairs = false);
// The stage's need where the largest of its tiles takes so many bytes.
StageMemory encode_memory(const Config& config, std::uint64_t largest);

// What the work refers to, and outlives it.
struct EncodeInputs {
  const Config& config;
  const EncodeJob& job;
  Hash128 planned;  // content of what the plan is made from
  const UnitPlan& plan;
  const LevelMeshes* levels = nullptr;  // the coarser ones, where there are some
  // The manifest but for what encode adds, once all units are there.
  std::function<Manifest()> manifest;
};

// Units as the plan has them, then the merged mesh, then tiles of coarser levels. Afterwards, where all are selected, the lists
// of files and the manifest.
std::unique_ptr<StageWork> encode_stage(EncodeInputs inputs);

}  // namespace voxweld
