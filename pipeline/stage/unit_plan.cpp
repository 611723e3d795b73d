#include "pipeline/stage/unit_plan.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/stage/file_layout.h"
#include "storage/artifact/label_top.h"

namespace voxweld {
namespace {

// So many tiles' files lie in one folder; those of more are spread by place.
constexpr std::uint64_t tiles_a_folder = 200;

std::filesystem::path tile_stem(const std::filesystem::path& root, CellKey tile,
                                std::uint64_t tiles) {
  return tiles > tiles_a_folder ? fanned_out(root, tile.at, cube_name(tile))
                                : root / cube_name(tile);
}

// One surface: a unit a tile.
class TilePlan : public UnitPlan {
 public:
  explicit TilePlan(std::vector<PlannedTile> tiles) : tiles_(std::move(tiles)) {}

  std::uint64_t size() const override { return tiles_.size(); }
  std::string name(std::uint64_t unit) const override {
    return "tile " + cube_name(tiles_[unit].key());
  }
  PlannedTile largest(std::uint64_t unit) const override { return tiles_[unit]; }
  PlannedTile total(std::uint64_t unit) const override { return tiles_[unit]; }
  std::filesystem::path path(const std::filesystem::path& root, std::uint64_t unit,
                             const std::string& ending) const override {
    const CellKey tile = tiles_[unit].key();
    return fanned_out(root, tile.at, cube_name(tile) + ending);
  }
  std::vector<PlannedMesh> meshes(std::uint64_t unit) const override {
    const PlannedTile& tile = tiles_[unit];
    return {{tile_stem("tiles", tile.key(), tiles_.size()).string(), tile.vertices}};
  }
  bool of_labels() const override { return false; }
  bool spread(std::uint64_t) const override { return false; }

 private:
  std::vector<PlannedTile> tiles_;
};

class BatchPlan : public UnitPlan {
 public:
  // as_whole: tiles were planned by other numbers of vertices than they have.
  BatchPlan(const ArtifactReader& file, bool as_whole)
      : top_(file), as_whole_(as_whole), batches_(top_.batches()) {}

  std::uint64_t size() const override { return batches_.size(); }
  std::string name(std::uint64_t unit) const override {
    const BatchRecord& batch = batches_[unit];
    if (of_several(batch))
      return fmt::format("label {} tile {}", batch.material, cube_name(batch.tile()));
    if (batch.surfaces == 1) return fmt::format("label {}", batch.material);
    return fmt::format("{} labels from {} on", batch.surfaces, batch.material);
  }
  PlannedTile largest(std::uint64_t unit) const override {
    const BatchRecord& batch = batches_[unit];
    return {batch.tile_code, static_cast<std::uint32_t>(batch.tile_level), 0, batch.most_vertices,
            batch.most_polygons};
  }
  PlannedTile total(std::uint64_t unit) const override {
    const BatchRecord& batch = batches_[unit];
    return {batch.tile_code, static_cast<std::uint32_t>(batch.tile_level), 0, batch.vertices,
            batch.polygons};
  }
  std::filesystem::path path(const std::filesystem::path& root, std::uint64_t unit,
                             const std::string& ending) const override {
    const BatchRecord& batch = batches_[unit];
    const std::string label = std::to_string(batch.material);
    const std::filesystem::path folder = label_folder(root, batch.material);
    if (!of_several(batch)) return folder / (label + ending);
    return fanned_out(folder / label, batch.tile().at, cube_name(batch.tile()) + ending);
  }
  std::vector<PlannedMesh> meshes(std::uint64_t unit) const override {
    const BatchRecord& batch = batches_[unit];
    const auto stem = [](Material label) {
      return label_folder("labels", label) / std::to_string(label);
    };
    if (of_several(batch))
      return {{tile_stem(stem(batch.material), batch.tile(), batch.surface_tiles).string(),
               counted_in(batch)}};
    std::vector<PlannedMesh> meshes;
    for (const SurfaceRecord& surface : top_.surfaces(batch.first_surface, batch.surfaces))
      meshes.push_back({stem(surface.material).string(), surface.vertices});
    return meshes;
  }
  bool of_labels() const override { return true; }
  bool spread(std::uint64_t unit) const override {
    return batches_[unit].surface_tiles > tiles_a_folder;
  }

 private:
  static bool of_several(const BatchRecord& batch) { return batch.surface_tiles > 1; }
  // Of a label of several tiles.
  std::uint64_t counted_in(const BatchRecord& batch) const {
    if (!as_whole_) return batch.vertices;
    const SurfaceRecord surface = top_.surfaces(batch.first_surface, 1).front();
    return batch.first_tile == surface.first_tile ? surface.vertices : 0;
  }

  LabelTop top_;
  bool as_whole_;
  std::vector<BatchRecord> batches_;
};

}  // namespace

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
  if (mode == LabelMode::each) return std::make_unique<BatchPlan>(top.file(), by_sheets);
  const LabelTop tables(top);
  return unit_plan(tables.tiles(0, tables.tile_count()));
}

std::unique_ptr<UnitPlan> unit_plan(const TilePlanArtifact& plan) {
  return std::make_unique<BatchPlan>(plan.file(), true);
}

std::unique_ptr<UnitPlan> unit_plan(std::vector<PlannedTile> tiles) {
  return std::make_unique<TilePlan>(std::move(tiles));
}

}  // namespace voxweld
