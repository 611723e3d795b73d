#include "stages/encode/tile_welder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"
#include "storage/types/index_table.h"

namespace voxweld {

void TileWelder::check_lattice(const TileMesh& tile) {
  if (triangles_ == 0) lattice_ = tile.lattice;
  if (!(tile.lattice == lattice_))
    throw InputError("cannot join tiles: they lie on different output lattices");
}

// Around a vertex each edge of the ring leads from one neighbour to the next: where the ring is closed
// they cancel out. Sums of mixed numbers that do so by chance are one in 2^64.
void TileWelder::find_open(const TileMesh& tile) {
  turns_.assign(tile.positions.size(), 0);
  const auto mixed = [](std::uint32_t v) { return mix_bits(std::uint64_t{v} + 1); };
  for (const auto& t : tile.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      turns_[t[k]] += mixed(t[(k + 1) % 3]) - mixed(t[(k + 2) % 3]);
  if (!tile.pairs.empty()) std::ranges::fill(turns_, std::uint64_t{1});
}

const TileWelder::Kept* TileWelder::find(const TileMesh& tile, std::uint32_t v,
                                         const std::vector<const Border*>& near) const {
  for (const Border* border : near) {
    if (!border->box.contains(tile.positions[v])) continue;
    const auto at = std::ranges::lower_bound(border->vertices, tile.ids[v], {}, &Kept::id);
    if (at != border->vertices.end() && at->id == tile.ids[v]) return &*at;
  }
  return nullptr;
}

void TileWelder::keep(const TileMesh& tile, const LatticeBox& box) {
  Border border{box, {}};
  border.vertices.reserve(
      static_cast<std::size_t>(std::ranges::count_if(turns_, [](auto turn) { return turn != 0; })));
  for (std::uint32_t v = 0; v < turns_.size(); ++v)
    if (turns_[v] != 0) border.vertices.push_back({tile.ids[v], numbers_[v], tile.positions[v]});
  std::ranges::sort(border.vertices, {}, &Kept::id);
  if (!border.vertices.empty()) borders_.push_back(std::move(border));
}

void TileWelder::add(const TileMesh& tile) {
  fresh_.clear();
  numbers_.assign(tile.positions.size(), none);
  if (tile.triangles.empty()) return;
  check_lattice(tile);
  find_open(tile);
  const LatticeBox box = LatticeBox::around(tile.positions);
  std::vector<const Border*> near;
  for (const Border& border : borders_)
    if (border.box.meets(box)) near.push_back(&border);
  for (const auto& t : tile.triangles)
    for (const std::uint32_t v : t) {
      if (numbers_[v] != none) continue;
      const Kept* const known = turns_[v] != 0 ? find(tile, v, near) : nullptr;
      if (known != nullptr && known->at != tile.positions[v])
        throw InputError(fmt::format(
            "cannot join tiles: vertex {:#x} is at ({}, {}, {}) in one and at ({}, {}, {}) in "
            "another",
            tile.ids[v].bits, known->at[0], known->at[1], known->at[2], tile.positions[v][0],
            tile.positions[v][1], tile.positions[v][2]));
      numbers_[v] = known != nullptr ? known->number : vertices_++;
      if (known == nullptr) fresh_.push_back(v);
    }
  triangles_ += tile.triangles.size();
  keep(tile, box);
}

std::uint64_t TileWelder::kept() const {
  std::uint64_t kept = 0;
  for (const Border& border : borders_) kept += border.vertices.size();
  return kept;
}

std::uint64_t TileWelder::kept_bytes(std::uint64_t vertices, bool between_labels) {
  // A flat square of n vertices has 4 sqrt(n) at its border; a tile is cut through by a few sheets.
  const auto border =
      static_cast<std::uint64_t>(16 * std::sqrt(static_cast<double>(vertices))) + 16;
  return sizeof(Kept) * (between_labels ? vertices : std::min(vertices, border));
}

}  // namespace voxweld
