#include "pipeline/refine/levels_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/stage/cube_mesh.h"
#include "stages/exact/orientation.h"
#include "stages/refine/coarsen.h"
#include "stages/refine/mesh_part.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

MeshSize size_of(const PartCounts& counts) {
  return {counts.vertices, counts.triangles, counts.samples, counts.sided};
}

// Surfaces that are done at once have no more triangles together, unless it is one alone.
constexpr std::uint64_t triangles_at_once = 1 << 16;

std::uint64_t bytes_of(const NodeReads& reads) {
  PartCounts all = reads.counts();
  all.samples = std::min(all.samples, all.triangles);  // as read() leaves them
  const std::uint64_t mesh = mesh_bytes(all.vertices, all.triangles, all.samples, all.sided);
  return std::max(
      gather_bytes(all.vertices, all.triangles, all.samples, all.sided) + reads.parts_bytes(),
      mesh + coarsen_bytes(size_of(all)));
}

double diagonal(const LatticeBox& box) {
  const Vec3 across = as_vec3(lattice_vector(box.lo, box.hi));
  return std::sqrt(dot(across, across));
}

// One of a node's surfaces, coarser.
struct Coarse {
  RefineMesh mesh;
  RefineCounts counts;
};
Coarse coarse(RefineMesh mesh, const NodeReads& reads, const NodeSources& sources,
              const LevelNode& node) {
  const LevelsJob& job = sources.job;
  Coarse out;
  if (mesh.triangles.empty()) return out;
  // A closed surface has four triangles at least. Of labels that are smaller than the tolerance a coarse
  // tile would have little else: they are left out, and as far off as they are large.
  if (sources.tree.of_labels() && reads.all()) {
    const double extent = diagonal(LatticeBox::around(mesh.positions));
    if (extent < level_tolerance(job.parameters.tolerance, node.doublings)) {
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) out.counts.add_distance(extent);
      out.counts.worst = extent;
      return out;
    }
  }
  out.mesh = coarsen(std::move(mesh), job.frame, {node.cell, reads.all(), node.doublings},
                     job.parameters, out.counts);
  return out;
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
      const auto children = static_cast<double>(node.nodes.size() + node.leaves.size());
      units.push_back({number, "tile of level " + node.name(), children});
    }
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit); });
  }

  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    const std::uint64_t tree = sources_.tree.of_labels() ? sources_.tree.bytes() : 0;
    return {"levels", tree, largest_bytes(numbers), "one tile of a coarser level",
            "raise run.memory, lower output.tile_vertices, or set output.levels to 1"};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    if (!NodeChildren(sources_, unit).are_there()) return 0;  // run() says so
    std::uint64_t most = 0;
    each_chunk(unit, [&](std::span<const NodeReads> chunk) {
      std::uint64_t sum = 0;
      for (const NodeReads& reads : chunk) sum += bytes_of(reads);
      most = std::max(most, sum);
    });
    return most;
  }

  void run(const Unit& unit, WorkerContext& worker) override {
    const LevelNode& node = node_of(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key));
    RefineCounts counts;
    const double tolerance = level_tolerance(job().parameters.tolerance, node.doublings);
    each_chunk(unit.key, [&](std::span<const NodeReads> chunk) {
      std::vector<Coarse> made(chunk.size());
      for_each_index(chunk.size(), [&](std::size_t i) {
        made[i] = coarse(chunk[i].read(tolerance, [&] { worker.check_interrupt(); }), chunk[i],
                         sources_, node);
      });
      worker.check_interrupt();
      for (std::size_t i = 0; i < chunk.size(); ++i) {
        counts.add(made[i].counts);
        if (made[i].mesh.triangles.empty()) continue;
        add_pieces(file, chunk[i].label(), made[i].mesh,
                   CubeLattice(job().frame, 0, node.cell.level));
      }
    });
    file.finish({as_record(counts)});
  }

 private:
  const LevelsJob& job() const { return sources_.job; }
  const LevelNode& node_of(std::uint64_t unit) const { return sources_.tree.nodes()[unit]; }
  std::filesystem::path path_of(std::uint64_t unit) const {
    return level_artifact_path(job().folder, node_of(unit));
  }
  // f(some of the node's surfaces) until all have been there, by label.
  template <class F>
  void each_chunk(std::uint64_t unit, F&& f) const {
    const NodeChildren children(sources_, unit);
    const std::vector<LevelSurface> surfaces = sources_.tree.surfaces(unit);
    std::vector<NodeReads> chunk;
    std::uint64_t triangles = 0;
    for (const LevelSurface& surface : surfaces) {
      NodeReads reads(sources_, unit, surface, children);
      const std::uint64_t more = reads.counts().triangles;
      if (!chunk.empty() && triangles + more > triangles_at_once) {
        f(std::span<const NodeReads>(chunk));
        chunk.clear();
        triangles = 0;
      }
      triangles += more;
      chunk.push_back(std::move(reads));
    }
    if (!chunk.empty()) f(std::span<const NodeReads>(chunk));
  }
  Hash128 key(std::uint64_t unit) const {
    KeyHasher key;
    key.hash(job().key).real(job().parameters.tolerance);
    sources_.tree.add_shape(key, unit);
    const NodeChildren children(sources_, unit);
    for (const LevelSurface& surface : sources_.tree.surfaces(unit))
      NodeReads(sources_, unit, surface, children).add_hashes(key);
    return key.finish();
  }

  const NodeSources sources_;
};

}  // namespace

std::unique_ptr<StageWork> levels_stage(const NodeSources& sources) {
  return std::make_unique<LevelsStage>(sources);
}

}  // namespace voxweld
