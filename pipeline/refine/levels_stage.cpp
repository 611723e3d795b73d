#include "pipeline/refine/levels_stage.h"

#include <fmt/format.h>

#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/coarsen.h"
#include "stages/refine/mesh_part.h"

namespace voxweld {
namespace {

MeshSize size_of(const PartCounts& counts) {
  return {counts.vertices, counts.triangles, counts.samples, counts.sided};
}

class LevelsStage final : public StageWork {
 public:
  explicit LevelsStage(const NodeSources& sources) : sources_(sources) {}

  Stage stage() const override { return Stage::levels; }
  std::string noun() const override { return "tiles"; }
  std::string identity() const override { return job().folder.filename().string(); }
  std::uint64_t size() const override { return sources_.tree.nodes().size(); }
  std::vector<std::uint64_t> rounds() const override { return sources_.tree.ends(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers) {
      const LevelNode& node = node_of(number);
      const auto children = static_cast<double>(node.nodes.size() + node.tiles.size());
      units.push_back({number, "tile of level " + node.name(), children});
    }
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(
        path, [&] { return CubeMeshArtifact(path).key() == key(unit, NodeReads(sources_, unit)); });
  }

  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    return {"levels", 0, largest_bytes(numbers), "one tile of a coarser level",
            "raise run.memory, lower output.tile_vertices, or set output.levels to 1"};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    const NodeReads reads(sources_, unit);
    if (!reads.children_are_there()) return 0;  // run() says so
    const PartCounts all = reads.counts();
    const std::uint64_t mesh = mesh_bytes(all.vertices, all.triangles, all.samples, all.sided);
    return std::max(gather_bytes(all.vertices, all.triangles, all.samples, all.sided) +
                        reads.largest_part_bytes(),
                    mesh + coarsen_bytes(size_of(all)));
  }

  void run(const Unit& unit, WorkerContext& worker) override {
    const LevelNode& node = node_of(unit.key);
    const NodeReads reads(sources_, unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, reads));
    RefineCounts counts;
    const RefineMesh mesh = coarsen(reads.read([&] { worker.check_interrupt(); }), job().frame,
                                    {node.cell, node.all, node.height}, job().parameters, counts);
    worker.check_interrupt();
    add_pieces(file, 0, mesh, CubeLattice(job().frame, 0, node.cell.level));
    file.finish({as_record(counts)});
  }

 private:
  const LevelsJob& job() const { return sources_.job; }
  const LevelNode& node_of(std::uint64_t unit) const { return sources_.tree.nodes()[unit]; }
  std::filesystem::path path_of(std::uint64_t unit) const {
    return level_artifact_path(job().folder, node_of(unit));
  }
  Hash128 key(std::uint64_t unit, const NodeReads& reads) const {
    KeyHasher key;
    key.hash(job().key).real(job().parameters.tolerance);
    sources_.tree.add_shape(key, unit);
    reads.add_hashes(key);
    return key.finish();
  }

  const NodeSources sources_;
};

}  // namespace

std::unique_ptr<StageWork> levels_stage(const NodeSources& sources) {
  return std::make_unique<LevelsStage>(sources);
}

}  // namespace voxweld
