#include "pipeline/ingest/ingest_layout.h"

#include "pipeline/stage/artifacts.h"

namespace voxweld {

StoreLayout store_layout(const Config& config, const IngestJob& job) {
  StoreLayout layout;
  layout.array = store_path(job.folder);
  layout.records = store_records_path(job.folder);
  layout.type = job.info.type;
  layout.geometry = job.info.geometry;
  layout.scale = job.info.scale;
  layout.parameters.chunk = config.work.chunk;
  layout.parameters.shard = config.work.brick * config.work.shard;
  return layout;
}

std::vector<Index3> shards_of(const StoreLayout& layout) {
  std::vector<Index3> shards;
  const Index3 grid = layout.shard_grid();
  for (std::int64_t z = 0; z < grid.z; ++z)
    for (std::int64_t y = 0; y < grid.y; ++y)
      for (std::int64_t x = 0; x < grid.x; ++x) shards.push_back({x, y, z});
  return shards;
}

void feed(KeyHasher& key, const FileState& state) {
  key.integer(static_cast<std::int64_t>(state.size));
  key.integer(state.mtime_ns).integer(state.ctime_ns);
}

Hash128 files_stamp(const IngestJob& job, std::size_t begin, std::size_t end) {
  KeyHasher stamp;
  stamp.hash(job.parameters);
  for (std::size_t i = begin; i < end; ++i) {
    stamp.text(job.info.files[i].path);
    feed(stamp, job.info.files[i].state);
  }
  return stamp.finish();
}

Hash128 box_stamp(const IngestJob& job, const Box3& samples) {
  if (!job.input || samples.empty()) return job.stamp;
  KeyHasher stamp;
  bool any = false;
  job.input->each_file(samples, [&](const std::filesystem::path& path) {
    any = true;
    if (const auto state = file_state(path)) feed(stamp.text(path.string()), *state);
  });
  return any ? stamp.hash(job.stamp).finish() : job.stamp;
}

Hash128 store_shard_key(const IngestJob& job, const StoreLayout& layout, Index3 shard) {
  const Box3 samples = layout.shard_samples(shard);
  if (!job.file_per_slice) return box_stamp(job, samples);
  return files_stamp(job, static_cast<std::size_t>(samples.lo.z),
                     static_cast<std::size_t>(samples.hi.z));
}

}  // namespace voxweld
