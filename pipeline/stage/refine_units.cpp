#include "pipeline/stage/refine_units.h"

#include <fmt/format.h>

#include <algorithm>

#include "storage/artifact/material_top.h"

namespace voxweld {
namespace {

// A label with more vertices is worth ranges of its own; small ones are put together up to so many.
constexpr std::uint64_t unit_vertices = 1 << 16;
constexpr std::uint64_t most_cut_ranges = 32;
// Of the only surface; fewer are not worth a file in each stage.
constexpr std::uint64_t range_vertices = 1 << 13;

std::uint64_t vertices_of(const std::vector<PlannedTile>& tiles) {
  std::uint64_t vertices = 0;
  for (const PlannedTile& tile : tiles) vertices += tile.vertices;
  return vertices;
}

// How many ranges there are to be at least, as far as cubes allow it, so that each has about so many.
std::size_t enough_ranges(const std::vector<PlannedTile>& tiles, std::uint64_t vertices) {
  return static_cast<std::size_t>(std::min(vertices_of(tiles) / vertices, most_cut_ranges));
}

// How others are cut does not matter to a label in ranges: what is done of it stays when they come
// or go.
void add_ranges(const std::vector<PlannedTile>& tiles, Material label, const CubeGrid& cubes,
                std::vector<RefineUnit>& units) {
  const auto ranges = cube_ranges(tiles, enough_ranges(tiles, unit_vertices), cubes);
  for (const PlannedRange& range : ranges)
    units.push_back({range, label, label + 1, 1, ranges.size() == 1});
}

// Labels of one tile each. A unit has none of two batches: what changes in one of them leaves the
// other's.
void add_small(const MaterialTop& top, const BatchRecord& batch, const CubeGrid& cubes,
               std::vector<RefineUnit>& units) {
  const auto surfaces = top.surfaces(batch.first_surface, batch.surfaces);
  const auto tiles = top.tiles(batch.first_tile, batch.tiles);
  bool open = false;  // the last unit takes more
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Material label = surfaces[i].material;
    const PlannedTile& tile = tiles[i];
    if (tile.vertices > unit_vertices) {
      add_ranges({tile}, label, cubes, units);
      open = false;
      continue;
    }
    if (!open || units.back().range.vertices + tile.vertices > unit_vertices)
      units.push_back({{}, label, label, 0, true});
    open = true;
    RefineUnit& unit = units.back();
    unit.end_label = label + 1;
    ++unit.labels;
    unit.range.vertices += tile.vertices;
    unit.range.polygons += tile.polygons;
  }
}

std::vector<RefineUnit> units_of_labels(const MaterialTop& top, const CubeGrid& cubes) {
  std::vector<RefineUnit> units;
  const std::vector<BatchRecord> batches = top.batches();
  for (std::size_t i = 0; i < batches.size(); ++i) {
    const BatchRecord& batch = batches[i];
    if (batch.surface_tiles == 1) {
      add_small(top, batch, cubes, units);
    } else if (i == 0 || batches[i - 1].material != batch.material) {
      add_ranges(top.tiles(batch.first_tile, batch.surface_tiles), batch.material, cubes, units);
    }
  }
  return units;
}

}  // namespace

std::string RefineUnit::name() const {
  const Index3 first = morton_decode(range.cubes.begin);
  std::string cubes = fmt::format("cubes from {}-{}-{} on", first.x, first.y, first.z);
  if (!of_labels()) return cubes;
  if (labels > 1) return fmt::format("{} labels from {} on", labels, first_label);
  return fmt::format("label {}{}", first_label, whole ? "" : " " + cubes);
}

std::vector<RefineUnit> refine_units(const TopArtifact& top, LabelMode mode,
                                     const CubeGrid& cubes) {
  const MaterialTop tables(top);
  if (mode == LabelMode::each) return units_of_labels(tables, cubes);
  std::vector<RefineUnit> units;
  const std::vector<PlannedTile> tiles = tables.tiles(0, tables.tile_count());
  for (const PlannedRange& range : cube_ranges(tiles, enough_ranges(tiles, range_vertices), cubes))
    units.push_back({range});
  return units;
}

}  // namespace voxweld
