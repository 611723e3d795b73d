#include "pipeline/stage/batch_planner.h"

#include <algorithm>

namespace voxweld {
namespace {

// Small labels are delivered several at a time. A batch ends before a label whose number says so,
// one in so many, and not by counting: then a label that comes or goes moves no batch but its own.
constexpr std::uint64_t labels_a_batch = 64, most_labels_a_batch = 256;

// Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

}  // namespace

void BatchPlanner::add(Material material, std::span<const PlannedTile> tiles,
                       std::uint64_t largest_piece, const AddInputs& add_inputs) {
  const std::uint64_t surface = out_.surfaces() - 1, first_tile = out_.tiles() - tiles.size();
  if (tiles.size() != 1 || ends_before(material, tiles[0])) finish();
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (!key_) begin(material, surface, first_tile + i, tiles.size(), tiles[i]);
    add_inputs(*key_, tiles[i]);
    ++batch_.tiles;
    batch_.vertices += tiles[i].vertices;
    batch_.polygons += tiles[i].polygons;
    batch_.most_vertices = std::max(batch_.most_vertices, tiles[i].vertices);
    batch_.most_polygons = std::max(batch_.most_polygons, tiles[i].polygons);
    batch_.largest_piece = std::max(batch_.largest_piece, largest_piece);
    if (tiles.size() > 1) finish();
  }
  if (tiles.size() == 1) batch_.surfaces = surface - batch_.first_surface + 1;
}

void BatchPlanner::finish() {
  if (!key_) return;
  batch_.inputs = key_->finish();
  out_.batch(batch_);
  key_.reset();
}

bool BatchPlanner::ends_before(Material material, const PlannedTile& tile) const {
  return key_ && (mixed(material) % labels_a_batch == 0 || batch_.tiles == most_labels_a_batch ||
                  batch_.vertices + tile.vertices > most_vertices_);
}

void BatchPlanner::begin(Material material, std::uint64_t surface, std::uint64_t first_tile,
                         std::uint64_t surface_tiles, const PlannedTile& tile) {
  key_.emplace();
  batch_ = {};
  batch_.material = material;
  batch_.first_surface = surface;
  batch_.surfaces = 1;
  batch_.first_tile = first_tile;
  batch_.surface_tiles = surface_tiles;
  batch_.tile_code = tile.code;
  batch_.tile_level = tile.level;
}

}  // namespace voxweld
