#include "pipeline/stage/unit_plan.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/stage/file_layout.h"
#include "storage/artifact/material_top.h"

namespace voxweld {
namespace {

// So many tiles' files lie in one folder; those of more are spread by place.
constexpr std::uint64_t tiles_a_folder = 200;

std::filesystem::path tile_stem(const std::filesystem::path& root, CellKey tile,
                                std::uint64_t tiles) {
  return tiles > tiles_a_folder ? fanned_out(root, tile.at, cube_name(tile))
                                : root / cube_name(tile);
}

bool of_several(const BatchRecord& unit) {
  return unit.surface_tiles > 1;
}

}  // namespace

UnitPlan::UnitPlan(const ArtifactReader& file, LabelMode mode, bool as_whole)
    : tables_(file),
      units_(tables_.batches()),
      of_labels_(mode == LabelMode::each),
      as_whole_(of_labels_ && as_whole) {}

std::string UnitPlan::name(std::uint64_t unit) const {
  const BatchRecord& batch = units_[unit];
  std::string tile = "tile " + cube_name(batch.tile());
  if (!of_labels()) return tile;
  if (of_several(batch)) return fmt::format("label {} {}", batch.material, tile);
  if (batch.surfaces == 1) return fmt::format("label {}", batch.material);
  return fmt::format("{} labels from {} on", batch.surfaces, batch.material);
}

PlannedTile UnitPlan::largest(std::uint64_t unit) const {
  const BatchRecord& batch = units_[unit];
  return {batch.tile_code, static_cast<std::uint32_t>(batch.tile_level), 0, batch.most_vertices,
          batch.most_polygons};
}

PlannedTile UnitPlan::total(std::uint64_t unit) const {
  const BatchRecord& batch = units_[unit];
  return {batch.tile_code, static_cast<std::uint32_t>(batch.tile_level), 0, batch.vertices,
          batch.polygons};
}

std::filesystem::path UnitPlan::path(const std::filesystem::path& root, std::uint64_t unit,
                                     const std::string& ending) const {
  const BatchRecord& batch = units_[unit];
  std::filesystem::path folder = root;
  if (of_labels()) {
    const std::string label = std::to_string(batch.material);
    folder = label_folder(root, batch.material);
    if (!of_several(batch)) return folder / (label + ending);
    folder /= label;
  }
  return fanned_out(folder, batch.tile().at, cube_name(batch.tile()) + ending);
}

std::vector<PlannedMesh> UnitPlan::meshes(std::uint64_t unit) const {
  const BatchRecord& batch = units_[unit];
  const auto label_stem = [](Material label) {
    return label_folder("labels", label) / std::to_string(label);
  };
  if (!of_labels() || of_several(batch)) {
    const auto root = of_labels() ? label_stem(batch.material) : std::filesystem::path("tiles");
    return {{tile_stem(root, batch.tile(), batch.surface_tiles).string(), counted_in(batch)}};
  }
  std::vector<PlannedMesh> meshes;
  for (const SurfaceRecord& surface : tables_.surfaces(batch.first_surface, batch.surfaces))
    meshes.push_back({label_stem(surface.material).string(), surface.vertices});
  return meshes;
}

std::vector<UnitTile> UnitPlan::tiles(std::uint64_t unit) const {
  const BatchRecord& batch = units_[unit];
  // So a surface's are known without its tables, however many there are.
  if (batch.tiles == 1) return {{batch.material, total(unit)}};
  const auto surfaces = tables_.surfaces(batch.first_surface, batch.surfaces);
  std::vector<UnitTile> tiles;
  for (const PlannedTile& tile : tables_.tiles(batch.first_tile, batch.tiles))
    tiles.push_back({surfaces[tiles.size()].material, tile});
  return tiles;
}

bool UnitPlan::spread(std::uint64_t unit) const {
  return of_labels() && units_[unit].surface_tiles > tiles_a_folder;
}

// By a tile of a surface, or of a label that has several.
std::uint64_t UnitPlan::counted_in(const BatchRecord& unit) const {
  if (!as_whole_) return unit.vertices;
  const SurfaceRecord surface = tables_.surfaces(unit.first_surface, 1).front();
  return unit.first_tile == surface.first_tile ? surface.vertices : 0;
}

std::string cube_name(CellKey tile) {
  return fmt::format("{}-{}-{}-{}", tile.level, tile.at.x, tile.at.y, tile.at.z);
}

std::filesystem::path label_folder(const std::filesystem::path& root, Material label) {
  std::filesystem::path folder = root;
  const std::uint64_t group = label >> 7;
  int digits = 0;
  while (digits < 8 && group >> (8 * digits) != 0) ++digits;
  // Their names begin with a letter, those of labels and tiles with a digit.
  for (int digit = digits - 1; digit >= 0; --digit)
    folder /= fmt::format("x{:02x}", group >> (8 * digit) & 255);
  return folder;
}

std::vector<PlannedTile> UnitPlan::largest_tiles() const {
  std::vector<PlannedTile> tiles;
  for (std::uint64_t unit = 0; unit < size(); ++unit) tiles.push_back(largest(unit));
  return tiles;
}

std::unique_ptr<UnitPlan> unit_plan(const TopArtifact& top, LabelMode mode, bool by_sheets) {
  return std::make_unique<UnitPlan>(top.file(), mode, by_sheets);
}

}  // namespace voxweld
