#include "storage/artifact/shard_summary.h"

namespace voxweld {
namespace {

constexpr std::uint64_t summary_section = shard_section(1);
constexpr std::uint64_t built_bricks_section = shard_section(5);
constexpr std::uint64_t runs_section = shard_section(6);

struct ShardSummaryRecord {
  std::uint64_t active_cells, crossing_edges, vertices, bricks, active_bricks, collapsed_above,
      unread;
  Hash128 input;
  LeafCounts by_level;
};

// Written as they lie in memory, so none may have padding, which would carry whatever was there
// before.
static_assert(std::has_unique_object_representations_v<BuiltRun> &&
              sizeof(LeafCounts) == std::size_t{12} * (max_levels + 1) &&
              sizeof(BrickCounts) == 24 + sizeof(LeafCounts) &&
              sizeof(BuiltBrick) == 24 + sizeof(BrickCounts));

// f(figure of the record, figure of the summary) of all.
template <class Record, class Summary, class F>
void each_figure(Record& record, Summary& summary, const F& f) {
  f(record.active_cells, summary.counts.active_cells);
  f(record.crossing_edges, summary.counts.crossing_edges);
  f(record.vertices, summary.counts.vertices);
  f(record.bricks, summary.bricks);
  f(record.active_bricks, summary.active_bricks);
  f(record.collapsed_above, summary.collapsed_above);
  f(record.unread, summary.unread);
  f(record.input, summary.input);
  f(record.by_level, summary.counts.by_level);
}

}  // namespace

void write_summary(ArtifactWriter& file, const ShardSummary& summary) {
  ShardSummaryRecord record;
  each_figure(record, summary, [](auto& to, const auto& from) { to = from; });
  file.section(summary_section, as_record(record));
}

ShardSummary read_summary(const ArtifactReader& file) {
  const auto record = file.read_record<ShardSummaryRecord>(summary_section, "has no summary");
  ShardSummary summary;
  each_figure(record, summary, [](const auto& from, auto& to) { to = from; });
  return summary;
}

void write_history(ArtifactWriter& file, const ShardHistory& history) {
  file.section(built_bricks_section, as_section(history.bricks));
  file.section(runs_section, as_section(history.runs));
}

ShardHistory read_history(const ArtifactReader& file) {
  return {file.read_array<BuiltBrick>(built_bricks_section),
          file.read_array<BuiltRun>(runs_section)};
}

}  // namespace voxweld
