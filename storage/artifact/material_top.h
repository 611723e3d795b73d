// The tables of merge's plan (top_artifact.h): the top tree and the tiles of each material. Those are
// the labels (labels.mode = "each"), else there is one, `sole_material`. In an artifact they are these
// sections:
//   5            MaterialTopTables (one)
//   6            BatchRecord
//   2 << 56 | i  page i of the tiles: PlannedTile, by material, then in Morton order
//   3 << 56 | i  page i of the surfaces: SurfaceRecord, one a material, ascending
//   4 << 56 | i  page i of the nodes: SurfaceNode, by material, then in Morton order
//   5 << 56 | i  page i of the leaves above the bricks: TopLeaf, by material, then in Morton order
//   6 << 56 | i  of the i-th material, where each sheet collapses by itself and some do above all
//                shards: the links (node_record_bytes.h) of the shards' clusters to the leaves above
//                all shards, which none of the shards has
// Pages as paged_table.h has them: of a million labels only the batches are ever held together. The
// plan of tiles of a refined mesh has the same tables (tile_plan_artifact.h).
#pragma once

#include "storage/artifact/paged_table.h"
#include "storage/types/material.h"
#include "storage/types/top_tree.h"

namespace voxweld {

class TopArtifact;

// One material: where its parts of the tables are.
struct SurfaceRecord {
  Material material = exterior;
  std::uint64_t first_tile = 0, tiles = 0;
  std::uint64_t first_node = 0, nodes = 0;
  std::uint64_t first_leaf = 0, leaves = 0;
  std::uint64_t vertices = 0;  // of its octree
  std::uint64_t polygons = 0;  // before those of fewer than three leaves are dropped
};

// A shard-sized cube in which the label has a surface.
struct SurfaceNode {
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  Hash128 content;         // MaterialNode::content
};

// What stitch and encode take as one unit, and leave as one artifact: one tile of a material that
// has several, or several labels of one tile each.
struct BatchRecord {
  Material material = exterior;  // its first one: names it
  std::uint64_t first_surface = 0, surfaces = 0;
  std::uint64_t first_tile = 0, tiles = 0;  // as many as surfaces, or one
  std::uint64_t surface_tiles = 0;          // that its label has: 1 where there are several labels
  std::uint64_t tile_code = 0, tile_level = 0;         // of its first tile
  std::uint64_t vertices = 0, polygons = 0;            // of all its tiles
  std::uint64_t most_vertices = 0, most_polygons = 0;  // of one tile
  std::uint64_t largest_piece = 0;                     // bytes, of what its tiles read
  Hash128 inputs;                                      // of labels: of all that stitching it reads

  CellKey tile() const { return CellKey::of(tile_code, tile_level); }
};

// Writes the tables beside what else their artifact has.
class MaterialTablesWriter {
 public:
  MaterialTablesWriter(const std::filesystem::path& path, const ArtifactStamp& stamp);
  // Of one material, each kind in Morton order; then the material itself. They ascend.
  void leaf(const TopLeaf& leaf);
  void tile(const PlannedTile& tile);
  void node(const SurfaceNode& node);
  void clusters(const ReducedNode& top);  // where it has leaves
  void end_surface(Material material);
  // The same where its mesh has another number of vertices than its tiles were planned by.
  void end_surface(Material material, std::uint64_t vertices);
  void batch(const BatchRecord& batch);  // in the order of their tiles
  // So far: numbers for the next batch to begin with.
  std::uint64_t surfaces() const { return surfaces_.size(); }
  std::uint64_t tiles() const { return tiles_.size(); }

 protected:
  ArtifactWriter& file() { return file_; }
  void finish_pages();
  Hash128 finish_tables();  // after all else

 private:
  ArtifactWriter file_;
  PagedTableWriter<PlannedTile> tiles_;
  PagedTableWriter<SurfaceRecord> surfaces_;
  PagedTableWriter<SurfaceNode> nodes_;
  PagedTableWriter<TopLeaf> leaves_;
  std::vector<BatchRecord> batches_;
  SurfaceRecord open_;  // the label under way
};

// Reads the tables of an artifact that outlives it. Thread-safe.
class MaterialTop {
 public:
  explicit MaterialTop(const ArtifactReader& file);
  explicit MaterialTop(const TopArtifact& top);

  std::uint64_t surface_count() const { return surfaces_.size(); }
  std::uint64_t tile_count() const { return tiles_.size(); }
  std::vector<BatchRecord> batches() const;
  std::vector<SurfaceRecord> surfaces(std::uint64_t first, std::uint64_t count) const {
    return surfaces_.read(first, count);
  }
  std::vector<PlannedTile> tiles(std::uint64_t first, std::uint64_t count) const {
    return tiles_.read(first, count);
  }
  // Those of a material whose cubes meet the Morton range [begin, end), in order. cube_level: of
  // nodes.
  std::vector<SurfaceNode> nodes(const SurfaceRecord& surface, int cube_level, std::uint64_t begin,
                                 std::uint64_t end) const;
  std::vector<TopLeaf> leaves(const SurfaceRecord& surface, std::uint64_t begin,
                              std::uint64_t end) const;
  // Of the surface with this number, where each sheet collapses by itself: all of it but the
  // record, and no link's root. Empty where nothing is above.
  ReducedNode clusters(std::uint64_t surface) const;
  std::uint64_t cluster_bytes(std::uint64_t surface) const;  // that this takes, about

 private:
  const ArtifactReader& file_;
  PagedTable<PlannedTile> tiles_;
  PagedTable<SurfaceRecord> surfaces_;
  PagedTable<SurfaceNode> nodes_;
  PagedTable<TopLeaf> leaves_;
};

}  // namespace voxweld
