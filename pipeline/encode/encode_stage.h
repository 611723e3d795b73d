// Encode: tile meshes to compressed assets, the merged mesh where it fits, and the manifest.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

// Units are numbered as UnitPlan has them; the merged mesh comes after them.
struct EncodeStatus {
  std::vector<std::uint64_t> missing;  // units whose files are missing, changed or of other inputs
  bool merged_missing = false;
  // Of tiles between labels: what the pairs that all of them list, one by one, take together, and
  // the most pairs that one of the missing lists.
  std::uint64_t label_pair_bytes = 0, most_label_pairs = 0;
  bool current() const { return missing.empty() && !merged_missing; }
};

// Whether the merged mesh is to be written: "auto" leaves it out when it does not fit run.memory.
// Throws InputError where it is asked for and does not fit.
struct MergedPlan {
  bool write = false;
  std::uint64_t bytes = 0;  // what it takes in memory
  std::string why_not;      // for the user, when auto leaves it out
};
// pair_bytes: what the pairs of its triangles take (labels.mode = "shared"), once stitch has found
// them.
MergedPlan plan_merged(const Config& config, const UnitPlan& units, std::uint64_t pair_bytes = 0);

// What encoding the largest of these tiles takes.
StageMemory encode_memory(const Config& config, const std::vector<PlannedTile>& tiles);

// Precondition: stitch is current.
EncodeStatus encode_status(const RunContext& context, const EncodeJob& job, const TopArtifact& top);
// Writes what is missing of the files context selects; where it selects all, also tiles.jsonl and
// manifest.json.
void run_encode(RunContext& context, const EncodeJob& job, Manifest manifest);

}  // namespace voxweld
