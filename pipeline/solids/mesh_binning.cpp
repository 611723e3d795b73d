#include "pipeline/solids/mesh_binning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "pipeline/executor/memory_budget.h"
#include "pipeline/stage/file_layout.h"
#include "stages/build/build_brick.h"
#include "stages/solids/local_mesh.h"
#include "storage/support/error.h"
#include "storage/support/record_sorter.h"

namespace voxweld {
namespace {

using Corners = std::array<Index3, 3>;

std::int64_t linear(Index3 at, Index3 size) {
  return (at.z * size.y + at.y) * size.x + at.x;
}
Index3 delinear(std::int64_t number, Index3 size) {
  return {number % size.x, number / size.x % size.y, number / size.x / size.y};
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - (a % b != 0 && a < 0 ? 1 : 0);
}

// The bricks whose samples a triangle's box may touch.
Box3 bricks_near(const Corners& c, const BrickGrid& grid) {
  const std::int64_t side = std::int64_t{1} << grid.brick_level();
  const Index3 lo = min(c[0], min(c[1], c[2])), hi = max(c[0], max(c[1], c[2]));
  Box3 bricks;
  for (int a = 0; a < 3; ++a) {
    // The samples -2 .. side of a brick, and those it begins and ends with are of two.
    bricks.lo[a] = std::max<std::int64_t>(floor_div(lo[a] >> mesh_cell_bits, side) - 1, 0);
    bricks.hi[a] = std::min(floor_div((hi[a] >> mesh_cell_bits) + 2, side) + 1, grid.bricks()[a]);
  }
  return bricks;
}

class Sweep {
 public:
  Sweep(const MeshBinning& binning, const BinLimits& limits)
      : binning_(binning), limits_(limits), grid_(binning.grid) {
    const Index3 shards = grid_.shards();
    table_.shards.assign(static_cast<std::size_t>(shards.x * shards.y * shards.z),
                         MeshSide::outside);
  }

  // In order of shard, then brick, then triangle.
  void add(std::uint64_t shard, std::uint64_t brick, const Corners& corners) {
    if (!open_ || shard != shard_ || brick != brick_) {
      close_brick();
      if (!open_ || shard != shard_) {
        close_shard();
        open_shard(shard);
      }
      brick_ = brick;
    }
    ++triangles_;
    if (too_large(triangles_)) bin_.corners = {};  // counted on, for the message
    if (!refused_ && !too_large(triangles_))
      bin_.corners.insert(bin_.corners.end(), corners.begin(), corners.end());
  }

  // The table; InputError where a bin was too large.
  const MeshTable& finish() {
    close_brick();
    close_shard();
    fill_shards(table_.shards.size());
    if (refused_) refuse();
    return table_;
  }

 private:
  Index3 brick_at(std::uint64_t number) const {
    return bricks_.lo + delinear(static_cast<std::int64_t>(number), bricks_.size());
  }
  std::vector<std::uint64_t>& rows_of(Index3 brick) {
    return rows_[static_cast<std::size_t>((brick.z - bricks_.lo.z) * bricks_.size().y + brick.y -
                                          bricks_.lo.y)];
  }
  static MeshSide side_of(const std::vector<std::uint64_t>& rows) {
    return (rows[0] & 1) != 0 ? MeshSide::inside : MeshSide::outside;
  }
  std::uint64_t bytes_of(std::uint64_t triangles) const {
    const std::int64_t side = (std::int64_t{1} << grid_.brick_level()) + 3;
    return LocalMesh::memory_bytes(triangles, {{}, splat(side)});
  }
  // Vectors grow to twice what they hold.
  std::uint64_t bytes_here(std::uint64_t triangles) const {
    return bytes_of(triangles) + triangles * sizeof(Corners);
  }
  bool too_large(std::uint64_t triangles) const {
    return bytes_here(triangles) > limits_.while_binning ||
           bytes_of(triangles) > limits_.while_building;
  }

  void open_shard(std::uint64_t shard);
  void close_brick();
  void close_shard();
  void fill_bricks(std::uint64_t end);
  void fill_shards(std::uint64_t end);
  [[noreturn]] void refuse() const;

  const MeshBinning& binning_;
  const BinLimits& limits_;
  const BrickGrid& grid_;
  MeshTable table_;
  bool refused_ = false;
  std::uint64_t next_shard_ = 0;

  // The shard at hand, and for each (y, z) of its bricks the sides of the rows of the next of them
  // along x; of the shards of one (y, z) the bricks' are the same.
  bool open_ = false;
  std::uint64_t shard_ = 0;
  Box3 bricks_;
  std::vector<std::vector<std::uint64_t>> rows_;
  std::vector<MeshSide> sides_;
  std::uint64_t next_brick_ = 0;
  std::unique_ptr<MeshBinsWriter> out_;  // null where its bins are there

  // The brick at hand.
  std::uint64_t brick_ = 0, triangles_ = 0;
  MeshBin bin_;
};

bool bins_are_there(const std::filesystem::path& path, Hash128 key) {
  if (!std::filesystem::exists(path)) return false;
  try {
    return MeshBins(path).key() == key;
  } catch (const DamagedArtifact&) {
    return false;
  }
}

void Sweep::open_shard(std::uint64_t number) {
  fill_shards(number);
  const Index3 shard = delinear(static_cast<std::int64_t>(number), grid_.shards());
  const Index3 last = delinear(static_cast<std::int64_t>(shard_), grid_.shards());
  const bool same_row = !rows_.empty() && shard.y == last.y && shard.z == last.z;
  bricks_ = grid_.shard_bricks(shard);
  if (!same_row) {
    // Before the first of them there is no mesh.
    rows_.assign(static_cast<std::size_t>(bricks_.size().y * bricks_.size().z), {});
    for (std::int64_t z = bricks_.lo.z; z < bricks_.hi.z; ++z)
      for (std::int64_t y = bricks_.lo.y; y < bricks_.hi.y; ++y)
        rows_of({0, y, z}).assign(row_words(binning_.samples_of({0, y, z})), 0);
  }
  open_ = true;
  shard_ = number;
  next_brick_ = 0;
  sides_.assign(static_cast<std::size_t>(bricks_.count()), MeshSide::outside);
  const auto path = binning_.bins_path(shard);
  if (!refused_ && !bins_are_there(path, binning_.key))
    out_ = std::make_unique<MeshBinsWriter>(path, binning_.key);
}

void Sweep::fill_bricks(std::uint64_t end) {
  for (; next_brick_ < end; ++next_brick_)
    sides_[next_brick_] = side_of(rows_of(brick_at(next_brick_)));
}

void Sweep::fill_shards(std::uint64_t end) {
  const auto row = [&](std::uint64_t number) {
    return static_cast<std::int64_t>(number) / grid_.shards().x;
  };
  for (; next_shard_ < end; ++next_shard_)
    if (!rows_.empty() && row(next_shard_) == row(shard_))
      table_.shards[next_shard_] = side_of(rows_[0]);
}

void Sweep::close_brick() {
  if (triangles_ == 0) return;
  const Index3 brick = brick_at(brick_);
  MeshTableFacts& facts = table_.facts;
  ++facts.bricks;
  facts.triangles += triangles_;
  if (triangles_ > facts.largest) {
    facts.largest = triangles_;
    facts.largest_brick = brick;
  }
  refused_ = refused_ || too_large(triangles_);
  triangles_ = 0;
  if (refused_) {
    out_.reset();
    return;
  }
  fill_bricks(brick_);
  sides_[next_brick_++] = MeshSide::reached;
  std::vector<std::uint64_t>& rows = rows_of(brick);
  bin_.first = rows;
  if (out_ != nullptr) out_->bin(brick_, bin_);
  const std::int64_t side = std::int64_t{1} << grid_.brick_level();
  if (brick.x + 1 < grid_.bricks().x) {
    const LocalMesh local(
        std::move(bin_),
        {binning_.samples_of(brick), binning_.geometry.spacing, {}, binning_.source});
    rows = local.sides_at((brick.x + 1) * side - 2);
  }
  bin_ = {};
}

void Sweep::close_shard() {
  if (!open_) return;
  open_ = false;
  next_shard_ = shard_ + 1;
  table_.shards[shard_] = MeshSide::reached;
  if (refused_) return;
  fill_bricks(sides_.size());
  if (out_ != nullptr) out_->commit(sides_);
  out_.reset();
}

void Sweep::refuse() const {
  constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
  const MeshTableFacts& facts = table_.facts;
  const std::uint64_t here = limits_.budget - limits_.while_binning + bytes_here(facts.largest);
  const std::uint64_t there = limits_.budget - limits_.while_building + bytes_of(facts.largest);
  // What sorting takes here grows with the budget, by a third of it.
  const std::uint64_t more = here > limits_.budget ? (here - limits_.budget) / 2 * 3 : 0;
  const std::uint64_t enough = std::max(there, limits_.budget + more) / mebibyte + 1;
  const Index3 b = facts.largest_brick;
  throw InputError(fmt::format(
      "run.memory = {} is too small: stage build needs at least {}MiB for one brick "
      "(work.brick = {}) with the {} triangles of the mesh that reach brick {}/{}/{}; "
      "raise run.memory{}",
      exact_bytes(limits_.budget), enough, std::int64_t{1} << grid_.brick_level(), facts.largest,
      b.x, b.y, b.z, grid_.brick_level() > min_brick_level ? " or lower work.brick" : ""));
}

}  // namespace

std::filesystem::path MeshBinning::bins_path(Index3 shard) const {
  return fanned_out(folder, shard, fmt::format("{}-{}-{}.bins", shard.x, shard.y, shard.z));
}

Box3 MeshBinning::samples_of(Index3 brick) const {
  return sign_samples(grid, brick);
}

std::uint64_t MeshBinning::shard_number(Index3 shard) const {
  return static_cast<std::uint64_t>(linear(shard, grid.shards()));
}

std::uint64_t MeshBinning::brick_number(Index3 brick) const {
  const Box3 bricks = grid.shard_bricks(grid.shard_of(brick));
  return static_cast<std::uint64_t>(linear(brick - bricks.lo, bricks.size()));
}

void bin_mesh(const SpooledMesh& mesh, const MeshBinning& binning, const MeshWork& work,
              const BinLimits& limits) {
  RecordSorter sorter(work.folder, work.memory / 3);
  mesh.each(
      [&](const SpooledMesh::Corners& places) {
        Corners corners;
        for (std::size_t i = 0; i < 3; ++i)
          corners[i] =
              snapped_corner(in_frame(places[i], binning.geometry), binning.geometry.spacing);
        const Box3 bricks = bricks_near(corners, binning.grid);
        for (std::int64_t z = bricks.lo.z; z < bricks.hi.z; ++z)
          for (std::int64_t y = bricks.lo.y; y < bricks.hi.y; ++y)
            for (std::int64_t x = bricks.lo.x; x < bricks.hi.x; ++x)
              if (const Index3 brick{x, y, z}; triangle_reaches(corners, binning.samples_of(brick)))
                sorter.push({binning.shard_number(binning.grid.shard_of(brick)),
                             binning.brick_number(brick)},
                            std::as_bytes(std::span(corners)));
      },
      work.between);
  Sweep sweep(binning, limits);
  SortKey key;
  std::vector<std::byte> record;
  for (std::uint64_t count = 0; sorter.next(key, record); ++count) {
    Corners corners;
    std::memcpy(corners.data(), record.data(), sizeof corners);
    sweep.add(key.major, key.minor, corners);
    if (work.between && count % 65536 == 0) work.between();
  }
  write_mesh_table(binning.table_path(), binning.key, sweep.finish());
}

}  // namespace voxweld
