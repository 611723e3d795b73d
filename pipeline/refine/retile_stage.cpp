#include "pipeline/refine/retile_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The pieces that may have triangles of one tile.
struct TilePieces {
  std::vector<PieceRead> pieces;
  std::uint64_t largest_part = 0;
  bool sided = false;  // their triangles have sides
};

class RetileStage final : public StageWork {
 public:
  RetileStage(const RetileJob& job, CubeMeshes& meshes, RetilePlan& plan)
      : job_(job), meshes_(meshes), plan_(plan), blocks_(tile_blocks(job.frame)) {
    for (std::size_t i = 0; i < plan.sources().size(); ++i) {
      const PlanSource& source = plan.sources()[i];
      spans_.add(source.pieces, source.lowest, source.highest, meshes.begins_layer(i));
    }
  }

  Stage stage() const override { return Stage::retile; }
  std::string noun() const override { return plan_.units().of_labels() ? "batches" : "tiles"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return plan_.units().size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers)
      units.push_back({number, plan_.units().name(number),
                       static_cast<double>(plan_.units().total(number).polygons)});
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return TileArtifact(path).key() == key(unit); });
  }
  StageLook look(const UnitSelection& selection) override {
    StageLook look = StageWork::look(selection);
    if (selection.all() && !plan_.on_disk()) look.rest = "the plan of tiles is missing";
    return look;
  }

  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    return {"retile", 0, largest_bytes(numbers),
            fmt::format("one tile (output.tile_vertices = {})", job_.tile_vertices),
            "raise run.memory or lower output.tile_vertices"};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    std::uint64_t most = 0;
    for (const UnitTile& refined : plan_.units().tiles(unit)) {
      const PlannedTile& tile = refined.tile;
      const TilePieces found = pieces_of(refined);
      // A tile also refers to vertices beyond its border.
      const std::uint64_t vertices = tile.vertices + tile.vertices / 4 + 1024;
      const std::uint64_t triangles = 2 * tile.polygons, sided = found.sided ? triangles : 0;
      most = std::max(most, gather_bytes(vertices, triangles, 0, sided) +
                                retile_bytes(vertices, triangles, sided) + found.largest_part);
    }
    return most;
  }
  void open(RunContext&, const StageLook&) override {
    if (!plan_.on_disk()) plan_.write();
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    TileWriter out(path_of(unit.key), key(unit.key), plan_.units().of_labels());
    for (const UnitTile& tile : plan_.units().tiles(unit.key))
      out.add(tile.material, mesh_of(tile, worker));
    out.finish();
  }

 private:
  std::filesystem::path path_of(std::uint64_t unit) const {
    return tile_artifact_path(job_.folder, plan_.units(), unit);
  }

  TileMesh mesh_of(const UnitTile& refined, const WorkerContext& worker) {
    const PlannedTile& planned = refined.tile;
    MeshGather mesh;
    const TilePieces found = pieces_of(refined);
    std::vector<PartRead> parts = parts_of(meshes_, found.pieces);
    // Of a smaller tile each of its pieces may have triangles in others, too.
    const bool holds_cubes = static_cast<int>(planned.level) >= job_.frame.level;
    const std::uint64_t shared = put_in_order(parts);
    mesh.reserve(planned.vertices, 2 * planned.polygons, 0, found.sided ? 2 * planned.polygons : 0,
                 holds_cubes ? shared : planned.vertices);
    for (const PartRead& part : parts) {
      worker.check_interrupt();
      const RefineMesh triangles =
          meshes_.read(spans_, part.piece.artifact, part.piece.piece, part.part,
                       {.normals = job_.normals, .aims = false, .samples = false});
      if (!holds_cubes)
        mesh.add(triangles,
                 [&](std::size_t t) { return belongs_to(triangles, t, blocks_, planned.key()); });
      else if (part.last)
        mesh.add_last(triangles);
      else
        mesh.add(triangles);
    }
    return to_tile_mesh(mesh.mesh(), planned.key(), job_.lattice, blocks_);
  }

  std::shared_ptr<const CubeMeshArtifact> open_planned(std::size_t artifact) {
    auto file = meshes_.open(artifact);
    if (file->content_hash() != plan_.sources()[artifact].content)
      throw DamagedArtifact(job_.plan_path().string(),
                            "was planned from another " + file->path() + " than is there");
    return file;
  }

  TilePieces pieces_of(const UnitTile& refined) {
    const PlannedTile& tile = refined.tile;
    const int bits = 3 * job_.frame.level;
    const std::uint64_t last = tile.code + (std::uint64_t{1} << (3 * tile.level)) - 1;
    const CubeKey begin{refined.material, tile.code >> bits},
        end{refined.material, (last >> bits) + 1};
    TilePieces found;
    spans_.each(begin, end, [&](std::size_t i) {
      each_piece_of(*open_planned(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
        found.pieces.push_back({i, p, true});
        found.sided = found.sided || piece.inside.sided + piece.leaving.sided > 0;
        found.largest_part =
            std::max({found.largest_part, part_bytes(piece.inside), part_bytes(piece.leaving)});
      });
    });
    return found;
  }

  Hash128 key(std::uint64_t unit) {
    KeyHasher key;
    key.hash(job_.key);
    for (const UnitTile& refined : plan_.units().tiles(unit)) {
      key.integer(static_cast<std::int64_t>(refined.material));
      key.integer(static_cast<std::int64_t>(refined.tile.code)).integer(refined.tile.level);
      for (const PieceRead& piece : pieces_of(refined).pieces)
        for (const CubePart part : {CubePart::inside, CubePart::leaving})
          meshes_.add_hashes(key, spans_, piece.artifact, piece.piece, part);
    }
    return key.finish();
  }

  const RetileJob& job_;
  CubeMeshes& meshes_;
  RetilePlan& plan_;
  PieceSpans spans_;  // of what is planned
  CubeLattice blocks_;
};

}  // namespace

std::unique_ptr<StageWork> retile_stage(const RetileJob& job, CubeMeshes& meshes,
                                        RetilePlan& plan) {
  return std::make_unique<RetileStage>(job, meshes, plan);
}

}  // namespace voxweld
