#include "pipeline/merge/merge_stage.h"

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/merge/material_merge.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {
namespace {

// Content hashes of what build has left, in the order of its units.
std::vector<Hash128> shard_hashes(const BuildJob& job) {
  const std::vector<Index3> shards = job.grid.all_shards();
  std::vector<Hash128> hashes(shards.size());
  probe_all(shards.size(),
            [&](std::size_t i) { hashes[i] = open_octrees(job, shards[i]).content_hash(); });
  return hashes;
}

// Of the nodes of all labels those that are held at once, beside the program itself.
std::uint64_t merge_memory(const RunContext& context) {
  constexpr std::uint64_t least = std::uint64_t{4} << 20, most = std::uint64_t{256} << 20;
  const std::uint64_t total = context.budget().total, taken = program_bytes();
  return std::clamp(total > taken ? (total - taken) / 4 : 0, least, most);
}

class MergeWork final : public StageWork {
 public:
  explicit MergeWork(const MergeJob& job) : job_(job) {}

  Stage stage() const override { return Stage::merge; }
  std::string noun() const override { return "trees"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return 1; }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    return std::vector<Unit>(numbers.size(), Unit{0, "top tree", 1});
  }
  bool done(std::uint64_t) override {
    return is_current(job_.path(), [&] {
      const TopArtifact artifact(job_.path());
      return artifact.key() == job_.key && artifact.shards() == shard_hashes(*job_.build);
    });
  }
  std::string missing_text(const StageLook&) const override { return {}; }

  StageMemory memory(std::span<const std::uint64_t>) override {
    return {"merge", 0, 0, "the top tree", "raise run.memory"};
  }
  void begin(RunContext& context, std::span<const std::uint64_t>, int) override {
    node_bytes_ = merge_memory(context);
  }
  void run(const Unit&, WorkerContext&) override { merge_materials(job_, node_bytes_); }

 private:
  const MergeJob& job_;
  std::uint64_t node_bytes_ = 0;
};

}  // namespace

bool merge_is_there(const MergeJob& job) {
  return std::filesystem::exists(job.path()) && TopArtifact(job.path()).key() == job.key;
}

std::unique_ptr<StageWork> merge_stage(const MergeJob& job) {
  return std::make_unique<MergeWork>(job);
}

}  // namespace voxweld
