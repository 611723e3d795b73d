// The labels of a volume, counted while it is ingested: each shard's on its own, by whoever writes
// it, then all together.
//
//   <ingest folder>/labels/...   the counts of each shard (label_counts.h)
//   <ingest folder>/labels.all   those of the volume
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/ingest/ingest_stage.h"
#include "storage/artifact/label_counts.h"
#include "storage/store/layout.h"

namespace voxweld {

// Whether the whole volume is counted.
bool labels_are_counted(const IngestJob& job);
// Whether the shard is.
bool shard_labels_are_counted(const IngestJob& job, const StoreLayout& layout, Index3 shard);

// Counts shards from the store or, where nothing is copied, from the input. From several threads.
class ShardLabelCounter {
 public:
  ShardLabelCounter(const IngestJob& job, const StoreLayout& layout) : job_(job), layout_(layout) {}

  void count(Index3 shard, const WorkerContext& worker);
  // Of one thread, the source's own included.
  static std::uint64_t memory_bytes(const IngestJob& job, const StoreLayout& layout);

 private:
  const IngestJob& job_;
  const StoreLayout& layout_;
};

// Adds up the shards' counts. Precondition: they are all there.
void join_label_counts(const RunContext& context, const IngestJob& job, const StoreLayout& layout);

// The volume's, where they are current.
std::optional<LabelCounts> read_label_counts(const IngestJob& job);

}  // namespace voxweld
