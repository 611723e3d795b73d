#include "pipeline/refine/find_stage.h"

#include <unordered_map>

#include "pipeline/refine/range_stage.h"
#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/find_pairs.h"
#include "stages/refine/mesh_part.h"

namespace voxweld {
namespace {

class FindStage final : public RangeStage {
 public:
  explicit FindStage(const RefineInputs& inputs) : RangeStage(inputs) {}

  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit, reads(unit)); });
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    std::uint64_t most = 0;
    for (const RangeReads& read : reads(unit)) {
      const PartCounts& all = read.all();
      most = std::max({most, reading_bytes(all, read.largest_part_bytes()),
                       mesh_bytes(all.vertices, all.triangles, all.samples, all.sided) +
                           find_pairs_bytes({all.vertices, all.triangles, 0, all.sided})});
    }
    return most;
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<RangeReads> all = reads(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all));
    RefineCounts counts;
    std::vector<IntersectionRecord> intersecting;
    if (job_.parameters.intersections != IntersectionRule::ignore)
      for (const RangeReads& read : all) {
        const RefineMesh mesh = read.read([&] { worker.check_interrupt(); },
                                          {.normals = false, .aims = false, .samples = false});
        const FoundPairs found = find_range_pairs(mesh, cubes_, range_of(unit.key));
        counts.pairs_before += found.pairs;
        add_intersections(read.label(), mesh, found.intersecting, cubes_, intersecting);
      }
    counts.pairs_left = counts.pairs_before;
    file.finish({as_record(counts), {}, {}, intersecting});
  }

 private:
  Hash128 key(std::uint64_t unit, const std::vector<RangeReads>& reads) const {
    return key_of(unit, reads).finish();
  }
};

}  // namespace

std::unique_ptr<StageWork> find_stage(const RefineInputs& inputs) {
  return std::make_unique<FindStage>(inputs);
}

}  // namespace voxweld
