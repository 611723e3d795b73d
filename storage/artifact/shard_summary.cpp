#include "storage/artifact/shard_summary.h"

namespace voxweld {
namespace {

constexpr std::uint64_t summary_section = shard_section(1);
constexpr std::uint64_t built_bricks_section = shard_section(5);
constexpr std::uint64_t runs_section = shard_section(6);

struct ShardSummaryRecord {
  std::uint64_t active_cells, crossing_edges, vertices, bricks, active_bricks, collapsed_above;
  double worst_residual, worst_finest;
  Hash128 input;
  std::array<std::uint64_t, max_levels + 1> leaves;
};

// Written as they lie in memory, so none may have padding, which would carry whatever was there
// before.
static_assert(std::has_unique_object_representations_v<BuiltRun> &&
              sizeof(BrickCounts) == 8 * (3 + max_levels + 1) + 16 &&
              sizeof(BuiltBrick) == 24 + sizeof(RootRecord) + sizeof(BrickCounts));

}  // namespace

void write_summary(ArtifactWriter& file, const ShardSummary& s) {
  const ShardSummaryRecord record{s.counts.active_cells,
                                  s.counts.crossing_edges,
                                  s.counts.vertices,
                                  s.bricks,
                                  s.active_bricks,
                                  s.collapsed_above,
                                  s.counts.worst_residual,
                                  s.counts.worst_finest,
                                  s.input,
                                  s.counts.leaves};
  file.section(summary_section, std::as_bytes(std::span(&record, 1)));
}

ShardSummary read_summary(const ArtifactReader& file) {
  std::vector<ShardSummaryRecord> records;
  file.read_array(summary_section, records);
  if (records.size() != 1) file.damaged("has no summary");
  const ShardSummaryRecord& r = records[0];
  ShardSummary s;
  s.counts.active_cells = r.active_cells;
  s.counts.crossing_edges = r.crossing_edges;
  s.counts.vertices = r.vertices;
  s.counts.worst_residual = r.worst_residual;
  s.counts.worst_finest = r.worst_finest;
  s.counts.leaves = r.leaves;
  s.bricks = r.bricks;
  s.active_bricks = r.active_bricks;
  s.collapsed_above = r.collapsed_above;
  s.input = r.input;
  return s;
}

void write_history(ArtifactWriter& file, const ShardHistory& history) {
  file.section(built_bricks_section, std::as_bytes(std::span(history.bricks)));
  file.section(runs_section, std::as_bytes(std::span(history.runs)));
}

ShardHistory read_history(const ArtifactReader& file) {
  ShardHistory history;
  file.read_array(built_bricks_section, history.bricks);
  file.read_array(runs_section, history.runs);
  return history;
}

}  // namespace voxweld
