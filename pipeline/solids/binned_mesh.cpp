#include "pipeline/solids/binned_mesh.h"

#include <cassert>

#include "stages/solids/local_mesh.h"
#include "storage/support/error.h"

namespace voxweld {

const MeshTable& BinnedMesh::table() const {
  const std::scoped_lock lock(mutex_);
  if (!table_) table_ = read_mesh_table(binning_.table_path(), binning_.key);
  return *table_;
}

// The highest of them: of samples -2 .. side of a brick it is that one.
Index3 BinnedMesh::brick_with(const Box3& samples) const {
  const int level = binning_.grid.brick_level();
  Index3 brick;
  for (int a = 0; a < 3; ++a)
    brick[a] = std::min((samples.lo[a] + 2) >> level, binning_.grid.bricks()[a] - 1);
  if (binning_.samples_of(brick).contains(samples)) return brick;
  // A part at a brick's end is the next one's too, but may begin before it.
  for (int a = 0; a < 3; ++a) brick[a] = std::max<std::int64_t>((samples.hi[a] - 2) >> level, 0);
  assert(binning_.samples_of(brick).contains(samples));
  return brick;
}

std::shared_ptr<const MeshBins> BinnedMesh::bins_of(Index3 brick) const {
  const Index3 shard = binning_.grid.shard_of(brick);
  const std::uint64_t number = binning_.shard_number(shard);
  if (table().shards.at(number) != MeshSide::reached) return nullptr;
  return shards_.get(number, [&] {
    auto bins = std::make_shared<MeshBins>(binning_.bins_path(shard));
    if (bins->key() != binning_.key)
      throw DamagedArtifact(bins->path(), "is of another input or other parameters");
    return bins;
  });
}

MeshSide BinnedMesh::side_of(Index3 brick, const MeshBins* bins) const {
  if (bins == nullptr) return table().shards[binning_.shard_number(binning_.grid.shard_of(brick))];
  const std::uint64_t number = binning_.brick_number(brick);
  if (number >= bins->bricks().size())
    throw DamagedArtifact(bins->path(), "has fewer bricks than its shard");
  return bins->bricks()[number];
}

std::optional<bool> BinnedMesh::side(const Box3& samples) const {
  const Index3 brick = brick_with(samples);
  const MeshSide side = side_of(brick, bins_of(brick).get());
  if (side == MeshSide::reached) return std::nullopt;
  return side == MeshSide::inside;
}

std::shared_ptr<const LatticeSolid> BinnedMesh::near(const Box3& samples) const {
  const Index3 brick = brick_with(samples);
  const auto bins = bins_of(brick);
  const MeshSide side = side_of(brick, bins.get());
  const LocalMeshFrame frame{binning_.samples_of(brick), binning_.geometry.spacing, bounds_,
                             source()};
  if (side == MeshSide::reached)
    return std::make_shared<LocalMesh>(bins->read(binning_.brick_number(brick), frame.samples),
                                       frame);
  MeshBin bin;
  bin.first.assign(row_words(frame.samples),
                   side == MeshSide::inside ? ~std::uint64_t{0} : std::uint64_t{0});
  return std::make_shared<LocalMesh>(std::move(bin), frame);
}

void BinnedMesh::each_flip(const Box3& samples,
                           const std::function<void(const Flip&)>& flip) const {
  if (!samples.empty()) near(samples)->each_flip(samples, flip);
}

LatticeSolid::Crossing BinnedMesh::crossing(int axis, Index3 s, bool low_inside) const {
  Box3 ends{s, s + splat(1)};
  ++ends.hi[axis];
  return near(ends)->crossing(axis, s, low_inside);
}

}  // namespace voxweld
