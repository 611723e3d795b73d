#include "pipeline/stitch/tile_pieces.h"

#include <algorithm>
#include <stdexcept>

#include "storage/support/error.h"

namespace voxweld {

ShardFiles::ShardFiles(const BuildJob& job, const TopArtifact& top)
    : job_(job), top_path_(top.path()), merged_(top.shards()) {
  for (const Index3& shard : job.grid.all_shards()) codes_.push_back(morton_encode(shard));
  if (merged_.size() != codes_.size()) throw DamagedArtifact(top_path_, "is of other shards");
}

Hash128 ShardFiles::merged_hash(Index3 shard) const {
  const auto at = std::lower_bound(codes_.begin(), codes_.end(), morton_encode(shard));
  return merged_[static_cast<std::size_t>(at - codes_.begin())];
}

std::shared_ptr<const ShardArtifact> ShardFiles::of_brick(Index3 brick) {
  if (!Box3{{}, job_.grid.bricks()}.contains(brick)) return nullptr;
  const Index3 shard = job_.grid.shard_of(brick);
  return open_.get(morton_encode(shard), [&] {
    auto file = std::make_shared<const ShardArtifact>(shard_artifact_path(job_, shard));
    if (file->key() != shard_key(job_, shard))
      throw DamagedArtifact(file->path(), "is of other parameters");
    if (file->content_hash() != merged_hash(shard))
      throw DamagedArtifact(top_path_,
                            "was merged from another " + file->path() + " than is there");
    return file;
  });
}

std::shared_ptr<const std::vector<PieceRecord>> MaterialPieces::of_shard(Index3 brick) {
  const BrickGrid& grid = files_.job().grid;
  if (!Box3{{}, grid.bricks()}.contains(brick)) return nullptr;
  return shards_.get(morton_encode(grid.shard_of(brick)), [&] {
    return std::make_shared<const std::vector<PieceRecord>>(
        files_.of_brick(brick)->pieces(material_));
  });
}

std::optional<PieceRecord> MaterialPieces::find(Index3 brick) {
  const auto pieces = of_shard(brick);
  if (pieces == nullptr) return std::nullopt;
  const std::uint64_t code = morton_encode(brick);
  const auto at = std::lower_bound(
      pieces->begin(), pieces->end(), code,
      [](const PieceRecord& piece, std::uint64_t c) { return piece.key.brick < c; });
  if (at == pieces->end() || at->key.brick != code) return std::nullopt;
  return *at;
}

bool MaterialPieces::read(Index3 brick, BrickOctree& out) {
  const auto piece = find(brick);
  if (piece) files_.of_brick(brick)->read_piece(*piece, files_.job().grid.brick_level(), out);
  return piece.has_value();
}

bool MaterialPieces::read_ghost_layer(Index3 brick, GhostLayer& out) {
  const auto piece = find(brick);
  if (piece) files_.of_brick(brick)->read_ghost_layer(*piece, out);
  return piece.has_value();
}

std::optional<ReducedNode> MaterialPieces::clusters(const CellKey& cube, Index3 brick) const {
  const auto file = files_.of_brick(brick);
  return file == nullptr ? std::nullopt : file->clusters(material_, cube);
}

const BrickOctree& ReadPieces::brick(const CellKey& key) {
  worker_.check_interrupt();
  if (!pieces_.read(key.at, scratch_.brick))
    throw std::logic_error("stitch: a brick of the tile has no piece");
  return scratch_.brick;
}

const GhostLayer* ReadPieces::ghost(Index3 brick, int direction) {
  GhostLayer& ghost = scratch_.upper[static_cast<std::size_t>(direction)];
  return pieces_.read_ghost_layer(brick, ghost) ? &ghost : nullptr;
}

}  // namespace voxweld
