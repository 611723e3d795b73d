#include "pipeline/refine/refine_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

class RefineStage final : public StageWork {
 public:
  explicit RefineStage(RefineInputs inputs)
      : job_(inputs.job),
        ranges_(inputs.ranges),
        tile_vertices_(inputs.tile_vertices),
        meshes_(inputs.maker, std::move(inputs.meshes)),
        cubes_(job_.frame, job_.pass),
        // What comes out is read by the other pass, or by retile in blocks of the first one's cubes.
        cubes_after_(job_.frame, 1 - job_.pass) {}

  Stage stage() const override { return job_.stage; }
  std::string noun() const override { return "ranges"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return ranges_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers) {
      const PlannedRange& range = ranges_[number];
      const Index3 first = morton_decode(range.cubes.begin);
      units.push_back({number, fmt::format("cubes from {}-{}-{} on", first.x, first.y, first.z),
                       static_cast<double>(range.vertices + range.polygons)});
    }
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit, reads(unit)); });
  }

  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    return {std::string(stage_name(job_.stage)), 0, largest_bytes(numbers),
            fmt::format("one range of cubes (output.tile_vertices = {})", tile_vertices_),
            "raise run.memory or lower output.tile_vertices"};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    const RangeReads read = reads(unit);
    const PartCounts &all = read.all(), &own = read.own();
    // A vertex that goes or moves leaves a sample.
    const std::uint64_t samples = own.samples + own.vertices;
    const std::uint64_t reading =
        gather_bytes(all.vertices, all.triangles, all.samples) + read.largest_part_bytes();
    const std::uint64_t refining =
        mesh_bytes(all.vertices, all.triangles, all.samples) +
        refine_bytes({all.vertices, all.triangles}, {own.vertices, own.triangles, samples});
    const std::uint64_t writing =
        mesh_bytes(own.vertices, own.triangles, samples) + piece_bytes(own.vertices, own.triangles);
    return std::max({reading, refining, writing});
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const RangeReads read = reads(unit.key);
    RefineMesh mesh = read.read([&] { worker.check_interrupt(); });
    RefineCounts counts;
    mesh = refine_range(mesh, cubes_, ranges_[unit.key].cubes, job_.parameters, counts);
    std::vector<CubeCount> blocks;
    if (job_.stage == Stage::seams) {
      blocks = count_blocks(mesh, tile_blocks(job_.frame));
      mesh.aims.clear();  // nobody asks for them any more
    }
    write_cube_mesh(path_of(unit.key), key(unit.key, read), mesh, cubes_after_, counts, blocks);
  }

 private:
  std::filesystem::path path_of(std::uint64_t unit) const {
    return range_artifact_path(job_, ranges_[unit].cubes);
  }
  RangeReads reads(std::uint64_t unit) { return {meshes_, cubes_, ranges_[unit].cubes}; }
  Hash128 key(std::uint64_t unit, const RangeReads& reads) const {
    const CubeRange& range = ranges_[unit].cubes;
    KeyHasher key;
    key.hash(job_.key)
        .integer(static_cast<std::int64_t>(range.begin))
        .integer(static_cast<std::int64_t>(range.end));
    reads.add_hashes(key);
    return key.finish();
  }

  const RefineJob& job_;
  const std::vector<PlannedRange>& ranges_;
  std::uint64_t tile_vertices_;
  CubeMeshes meshes_;
  CubeLattice cubes_, cubes_after_;
};

}  // namespace

std::unique_ptr<StageWork> refine_stage(RefineInputs inputs) {
  return std::make_unique<RefineStage>(std::move(inputs));
}

std::vector<std::filesystem::path> refined_meshes(const RefineJob& job,
                                                  const std::vector<PlannedRange>& ranges) {
  std::vector<std::filesystem::path> paths;
  paths.reserve(ranges.size());
  for (const PlannedRange& range : ranges) paths.push_back(range_artifact_path(job, range.cubes));
  return paths;
}

RefineCounts refine_counts(const RefineJob& job, const std::vector<PlannedRange>& ranges) {
  const auto paths = refined_meshes(job, ranges);
  std::vector<RefineCounts> counts(paths.size());
  probe_all(paths.size(),
            [&](std::size_t i) { counts[i] = CubeMeshArtifact(paths[i]).counted<RefineCounts>(); });
  RefineCounts sum;
  for (const RefineCounts& one : counts) sum.add(one);
  return sum;
}

}  // namespace voxweld
