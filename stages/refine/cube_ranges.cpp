#include "stages/refine/cube_ranges.h"

#include <algorithm>
#include <map>

namespace voxweld {

namespace {

using Tiles = std::vector<PlannedTile>;

// Whether cells of the volume may lie there.
bool reaches(Index3 size, const PlannedTile& tile) {
  const Index3 lo = morton_decode(tile.code);
  return size == Index3{} || (lo.x < size.x && lo.y < size.y && lo.z < size.z);
}

// Those for which asks(number) holds each in eight, or as many of these as lie in a volume of that size.
// (A domain is a power of two a side: of one around 512^3 seven octants are empty.)
template <class Asks>
Tiles cut(const Tiles& tiles, Index3 size, Asks&& asks) {
  Tiles parts;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const PlannedTile& tile = tiles[i];
    if (!asks(i)) {
      parts.push_back(tile);
      continue;
    }
    const std::size_t first = parts.size();
    for (std::uint64_t octant = 0; octant < 8; ++octant) {
      PlannedTile part = tile;
      part.level = tile.level - 1;
      part.code = tile.code + (octant << (3 * part.level));
      if (octant == 0 || reaches(size, part)) parts.push_back(part);
    }
    const std::uint64_t count = parts.size() - first;
    for (PlannedTile& part : std::span(parts).subspan(first)) {
      part.vertices = (tile.vertices + count - 1) / count;
      part.polygons = (tile.polygons + count - 1) / count;
    }
  }
  return parts;
}

// Vertices in single cubes, as far as tiles are no larger, by the cube's Morton number.
struct CubeLoad {
  std::uint64_t cube = 0, vertices = 0;
};
std::vector<CubeLoad> loads_of_cubes(const Tiles& tiles, std::uint32_t level) {
  std::vector<CubeLoad> loads;
  for (const PlannedTile& tile : tiles) {
    if (tile.level > level) continue;
    const std::uint64_t cube = tile.code >> (3 * level);
    if (loads.empty() || loads.back().cube != cube) loads.push_back({cube});
    loads.back().vertices += tile.vertices;
  }
  return loads;
}

// The most vertices that a tile has, or that lie in one cube.
std::uint64_t fullest(const Tiles& tiles, const std::vector<CubeLoad>& loads) {
  std::uint64_t most = 0;
  for (const PlannedTile& tile : tiles) most = std::max(most, tile.vertices);
  for (const CubeLoad& load : loads) most = std::max(most, load.vertices);
  return most;
}

// f(cube, vertices) for the cubes of the second pass that begin in this one, but for that which counts to
// it: each has an eighth of it.
template <class F>
void each_above(const CubeLoad& load, F&& f) {
  const Index3 cube = morton_decode(load.cube);
  for (int octant = 1; octant < 8; ++octant)
    f(cube + Index3{octant & 1, octant >> 1 & 1, octant >> 2}, load.vertices / 8);
}

// The number of the tile that lies last at or before this Morton code and reaches it; or of none.
std::size_t tile_at(const Tiles& tiles, std::uint64_t code) {
  const auto after = std::ranges::upper_bound(tiles, code, {}, &PlannedTile::code);
  if (after == tiles.begin()) return tiles.size();
  const auto tile = after - 1;
  return (code - tile->code) >> (3 * tile->level) == 0
             ? static_cast<std::size_t>(tile - tiles.begin())
             : tiles.size();
}

// In the second pass cubes are shifted down by half a side. So a tile of several cubes, where little
// lies, has half of those below, where much may lie. Which tiles would have more than the fullest one
// has in the first pass.
std::vector<bool> overloaded(const Tiles& tiles, std::uint32_t level) {
  const std::vector<CubeLoad> loads = loads_of_cubes(tiles, level);
  const std::uint64_t most = fullest(tiles, loads);
  std::vector<std::uint64_t> vertices;
  for (const PlannedTile& tile : tiles) vertices.push_back(tile.vertices);
  for (const CubeLoad& load : loads)
    each_above(load, [&](Index3 above, std::uint64_t part) {
      const std::size_t tile = tile_at(tiles, morton_encode(above) << (3 * level));
      if (tile < tiles.size()) vertices[tile] += part;
    });
  std::vector<bool> over(tiles.size());
  for (std::size_t i = 0; i < tiles.size(); ++i)
    over[i] = tiles[i].level > level && vertices[i] > most;
  return over;
}

Tiles even_tiles(Tiles tiles, std::uint32_t level, Index3 size) {
  for (;;) {
    const std::vector<bool> over = overloaded(tiles, level);
    if (std::ranges::find(over, true) == over.end()) return tiles;
    tiles = cut(tiles, size, [&](std::size_t i) { return over[i]; });
  }
}

// What cubes of the second pass have where there is no tile, by their numbers. Those past the domain count to
// its last ones (CubeLattice::code).
std::map<std::uint64_t, std::uint64_t> loads_beyond(const Tiles& tiles,
                                                    const std::vector<CubeLoad>& loads,
                                                    const CubeGrid& cubes) {
  std::map<std::uint64_t, std::uint64_t> beyond;
  for (const CubeLoad& load : loads)
    each_above(load, [&](Index3 above, std::uint64_t part) {
      if (std::max({above.x, above.y, above.z}) >= cubes.side) return;
      const std::uint64_t number = morton_encode(above);
      if (tile_at(tiles, number << (3 * cubes.level)) == tiles.size()) beyond[number] += part;
    });
  return beyond;
}

// Ranges one after the other.
class RangeList {
 public:
  RangeList(const Tiles& tiles, const std::vector<CubeLoad>& loads, const CubeGrid& cubes)
      : beyond_(loads_beyond(tiles, loads, cubes)),
        next_(beyond_.begin()),
        most_(fullest(tiles, loads)) {}
  void add(const PlannedTile& tile, std::uint64_t cube) {
    if (ranges_.empty()) {
      ranges_.emplace_back();
    } else if (cube_ != cube) {
      end_before(cube);
      begin(cube);
    }
    cube_ = cube;
    load_ += tile.vertices;
    ranges_.back().vertices += tile.vertices;
    ranges_.back().polygons += tile.polygons;
  }
  std::vector<PlannedRange> take() {
    if (!ranges_.empty()) end_before(CubeRange{}.end);
    return std::move(ranges_);
  }

 private:
  void begin(std::uint64_t cube) {
    ranges_.back().cubes.end = cube;
    ranges_.push_back({{cube, CubeRange{}.end}});
    load_ = 0;
  }
  // The cubes between the tile before and this one.
  void end_before(std::uint64_t cube) {
    for (; next_ != beyond_.end() && next_->first < cube; ++next_) {
      if (next_->first <= cube_) continue;  // the tile begins further up in it
      if (load_ + next_->second > most_) begin(next_->first);
      load_ += next_->second;
    }
  }

  const std::map<std::uint64_t, std::uint64_t> beyond_;
  std::map<std::uint64_t, std::uint64_t>::const_iterator next_;
  std::vector<PlannedRange> ranges_;
  const std::uint64_t most_;  // that a range should have
  std::uint64_t cube_ = 0;    // of the tile before
  std::uint64_t load_ = 0;    // of the last range
};

}  // namespace

CubeGrid cubes_of(const RefineFrame& frame) {
  const int levels = std::max(0, domain_level(frame.size) - frame.level);
  return {frame.level, std::int64_t{1} << levels, frame.size};
}

std::vector<PlannedRange> cube_ranges(std::span<const PlannedTile> planned, std::size_t enough,
                                      const CubeGrid& cubes) {
  const auto cube_level = static_cast<std::uint32_t>(cubes.level);
  Tiles tiles = even_tiles({planned.begin(), planned.end()}, cube_level, cubes.size);
  const auto is_large = [&](const PlannedTile& tile) { return tile.level > cube_level; };
  while (tiles.size() < enough && std::ranges::any_of(tiles, is_large))
    tiles = cut(tiles, cubes.size, [&](std::size_t i) { return is_large(tiles[i]); });
  RangeList ranges(tiles, loads_of_cubes(tiles, cube_level), cubes);
  for (const PlannedTile& tile : tiles) ranges.add(tile, tile.code >> (3 * cube_level));
  return ranges.take();
}

}  // namespace voxweld
