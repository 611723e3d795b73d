// What merge or retile has planned, as stitch and encode take it: in units. A unit is a tile; of labels
// (labels.mode = "each") one tile of a label that has several, or several labels of one tile each,
// so that a million of them are not a million units and artifacts.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "storage/artifact/material_top.h"
#include "storage/artifact/top_artifact.h"
#include "storage/types/material.h"

namespace voxweld {

struct PlannedMesh {
  std::string stem;  // of its files: relative to the output directory, without their endings
  // Of the octree that lie in its tile. Where only the label's are known, as of refined tiles, or
  // where each sheet collapses by itself, its first tile has all. So the sum is the label's.
  std::uint64_t vertices = 0;
};

// A tile of a unit. The material is the label, or `sole_material`.
struct UnitTile {
  Material material = sole_material;
  PlannedTile tile;
};

class UnitPlan {
 public:
  // By the tables in a file that outlives it. as_whole: of labels, whose tiles were planned by other
  // numbers of vertices than they have.
  UnitPlan(const ArtifactReader& file, LabelMode mode, bool as_whole);

  // Units are numbered in Morton order, those of labels by label first.
  std::uint64_t size() const { return units_.size(); }
  std::string name(std::uint64_t unit) const;  // "tile 7-0-0-0", "labels from 12 on"
  // Vertices and polygons of its largest tile, and of all it has.
  PlannedTile largest(std::uint64_t unit) const;
  PlannedTile total(std::uint64_t unit) const;
  // Where its artifact or record is, below `root`: in folders that stay small.
  std::filesystem::path path(const std::filesystem::path& root, std::uint64_t unit,
                             const std::string& ending) const;
  // Its first tile's number among those of all units.
  std::uint64_t first_tile(std::uint64_t unit) const { return units_[unit].first_tile; }
  // Its meshes, and its tiles, in their order. Thread-safe.
  std::vector<PlannedMesh> meshes(std::uint64_t unit) const;
  std::vector<UnitTile> tiles(std::uint64_t unit) const;
  // Whether each mesh is the closed surface of one label: those of neighbours lie on each other, so
  // that all of them are no one mesh.
  bool of_labels() const { return of_labels_; }
  // Of a label: its files are spread over folders, since it has so many.
  bool spread(std::uint64_t unit) const;
  // The largest tile of each unit.
  std::vector<PlannedTile> largest_tiles() const;

 private:
  std::uint64_t counted_in(const BatchRecord& unit) const;

  MaterialTop tables_;
  std::vector<BatchRecord> units_;
  bool of_labels_, as_whole_;
};

// mode, by_sheets: of the run that made the top tree, which the plan refers to.
std::unique_ptr<UnitPlan> unit_plan(const TopArtifact& top, LabelMode mode, bool by_sheets = false);

std::string cube_name(CellKey tile);  // "7-0-0-0": level and index, the same in every run

// For a label's files: a folder for each 128 labels, named by the higher bytes of their numbers.
std::filesystem::path label_folder(const std::filesystem::path& root, Material label);

}  // namespace voxweld
