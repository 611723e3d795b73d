#include "pipeline/stitch/stitch_work.h"

#include <utility>

#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/retile.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {

StitchWork::StitchWork(const StitchJob& job, const TopArtifact& top)
    : job_(job),
      of_labels_(job.build->parameters.labels.mode == LabelMode::each),
      top_(top),
      batches_(top_.batches()),
      files_(*job.build, top) {
  if (job.cubes) cubes_.emplace(*job.cubes, 0);
}

// f(number of the surface, it, tile) of the unit's tiles.
template <class F>
void StitchWork::each_tile(std::uint64_t unit, F&& f) const {
  const BatchRecord& batch = batches_[unit];
  const auto surfaces = top_.surfaces(batch.first_surface, batch.surfaces);
  const auto tiles = top_.tiles(batch.first_tile, batch.tiles);
  for (std::size_t i = 0; i < tiles.size(); ++i) f(batch.first_surface + i, surfaces[i], tiles[i]);
}

// Merge has looked at all that it reads.
Hash128 StitchWork::key_of_labels(std::uint64_t unit) const {
  return KeyHasher().hash(job_.key).hash(batches_[unit].inputs).finish();
}

Hash128 StitchWork::key(std::uint64_t unit) {
  if (of_labels_) return key_of_labels(unit);
  Hash128 key;
  each_tile(unit, [&](std::uint64_t number, const SurfaceRecord& surface, const PlannedTile& tile) {
    MaterialPieces pieces(files_, surface.material);
    key = tile_key(job_, tile, inputs_of(number, surface, tile, pieces), pieces);
  });
  return key;
}

Hash128 StitchWork::key_of(const std::filesystem::path& path) const {
  return job_.cubes ? CubeMeshArtifact(path).key() : TileArtifact(path).key();
}

TileInputs StitchWork::inputs_of(std::uint64_t number, const SurfaceRecord& surface,
                                 const PlannedTile& tile, MaterialPieces& pieces) {
  const auto clusters = clusters_.get(
      number, [&] { return std::make_shared<const ReducedNode>(top_.clusters(number)); });
  return tile_inputs(*job_.build, top_, surface, tile, *clusters, pieces);
}

// f(key of the unit, material, mesh) of the unit's tiles.
template <class F>
void StitchWork::each_mesh(std::uint64_t unit, StitchScratch& scratch, WorkerContext& worker,
                           F&& f) {
  each_tile(unit, [&](std::uint64_t number, const SurfaceRecord& surface, const PlannedTile& tile) {
    MaterialPieces pieces(files_, surface.material);
    const TileInputs inputs = inputs_of(number, surface, tile, pieces);
    ReadPieces read(pieces, scratch, worker);
    f(of_labels_ ? key_of_labels(unit) : tile_key(job_, tile, inputs, pieces), surface.material,
      collapses_by_sheets(job_.build->parameters)
          ? stitch_tile(tile, job_.parameters, inputs.bricks, inputs.clusters, read)
          : stitch_tile(tile, job_.parameters, inputs.bricks, inputs.leaves, read));
  });
}

void StitchWork::run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
                     WorkerContext& worker) {
  if (cubes_) {
    std::optional<CubeMeshWriter> out;
    std::vector<BlockRecord> blocks;
    each_mesh(unit, scratch, worker, [&](const Hash128& key, Material material, TileMesh mesh) {
      if (!out) out.emplace(path, key);
      const RefineMesh stitched = to_refine_mesh(std::move(mesh));
      add_blocks(material, stitched, tile_blocks(*job_.cubes), blocks);
      add_pieces(*out, material, stitched, *cubes_);
    });
    finish_stitched(*out, blocks);
  } else {
    std::optional<TileWriter> out;
    each_mesh(unit, scratch, worker, [&](const Hash128& key, Material material, TileMesh&& mesh) {
      if (!out) out.emplace(path, key, of_labels_);
      out->add(material, mesh);
    });
    out->finish();
  }
}

}  // namespace voxweld
