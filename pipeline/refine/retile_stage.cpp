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
};

class RetileStage final : public StageWork {
 public:
  RetileStage(const RetileJob& job, CubeMeshes& meshes, RetilePlan& plan)
      : job_(job), meshes_(meshes), plan_(plan), blocks_(tile_blocks(job.frame)) {}

  Stage stage() const override { return Stage::retile; }
  std::string noun() const override { return "tiles"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return plan_.units().size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers)
      units.push_back({number, plan_.units().name(number),
                       static_cast<double>(plan_.tiles()[number].polygons)});
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return TileArtifact(path).key() == key(unit, pieces_of(unit)); });
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
    const PlannedTile& tile = plan_.tiles()[unit];
    // A tile also refers to vertices beyond its border.
    const std::uint64_t vertices = tile.vertices + tile.vertices / 4 + 1024;
    return gather_bytes(vertices, 2 * tile.polygons, 0) +
           retile_bytes(vertices, 2 * tile.polygons) + pieces_of(unit).largest_part;
  }
  void open(RunContext&, const StageLook&) override {
    if (!plan_.on_disk()) plan_.write();
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const CellKey tile = plan_.tiles()[unit.key].key();
    const TilePieces found = pieces_of(unit.key);
    MeshGather mesh;
    const PlannedTile& planned = plan_.tiles()[unit.key];
    mesh.reserve(planned.vertices, 2 * planned.polygons, 0);
    for (const PieceRead& piece : found.pieces) {
      worker.check_interrupt();
      const auto artifact = open_planned(piece.artifact);
      for (const CubePart part : {CubePart::inside, CubePart::leaving}) {
        RefineMesh triangles = artifact->read(piece.piece, part);
        triangles.samples.clear();
        mesh.add(triangles, [&](std::size_t t) { return belongs_to(triangles, t, blocks_, tile); });
      }
    }
    TileMesh out = to_tile_mesh(mesh.mesh(), tile, job_.lattice, blocks_);
    if (!job_.normals) {
      out.normals.clear();
      out.corner_normals.clear();
    }
    write_tile(path_of(unit.key), key(unit.key, found), out);
  }

 private:
  std::filesystem::path path_of(std::uint64_t unit) const {
    return tile_artifact_path(job_.folder, plan_.units(), unit);
  }

  std::shared_ptr<const CubeMeshArtifact> open_planned(std::size_t artifact) {
    auto file = meshes_.open(artifact);
    if (file->content_hash() != plan_.sources()[artifact].content)
      throw DamagedArtifact(job_.plan_path().string(),
                            "was planned from another " + file->path() + " than is there");
    return file;
  }

  TilePieces pieces_of(std::uint64_t unit) {
    const PlannedTile& tile = plan_.tiles()[unit];
    constexpr int bits = 3 * refine_cube_level;
    const std::uint64_t begin = tile.code >> bits,
                        end =
                            ((tile.code + (std::uint64_t{1} << (3 * tile.level)) - 1) >> bits) + 1;
    TilePieces found;
    for (std::size_t i = 0; i < plan_.sources().size(); ++i) {
      const PlanSource& source = plan_.sources()[i];
      if (source.pieces == 0 || source.highest_code < begin || end <= source.lowest_code) continue;
      const auto artifact = open_planned(i);
      const auto pieces = artifact->pieces();
      for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (pieces[p].code < begin || end <= pieces[p].code) continue;
        found.pieces.push_back({i, p, true});
        found.largest_part = std::max(
            {found.largest_part, part_bytes(pieces[p].inside), part_bytes(pieces[p].leaving)});
      }
    }
    return found;
  }

  Hash128 key(std::uint64_t unit, const TilePieces& found) {
    const PlannedTile& tile = plan_.tiles()[unit];
    KeyHasher key;
    key.hash(job_.key).integer(static_cast<std::int64_t>(tile.code)).integer(tile.level);
    for (const PieceRead& piece : found.pieces) {
      const auto artifact = open_planned(piece.artifact);
      for (const CubePart part : {CubePart::inside, CubePart::leaving})
        key.hash(artifact->part_hash(piece.piece, part));
    }
    return key.finish();
  }

  const RetileJob& job_;
  CubeMeshes& meshes_;
  RetilePlan& plan_;
  CubeLattice blocks_;
};

}  // namespace

std::unique_ptr<StageWork> retile_stage(const RetileJob& job, CubeMeshes& meshes,
                                        RetilePlan& plan) {
  return std::make_unique<RetileStage>(job, meshes, plan);
}

}  // namespace voxweld
