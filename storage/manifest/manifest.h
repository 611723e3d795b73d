// The summary of an output directory (manifest.json) and its list of tiles (tiles.jsonl).
//
// manifest.json, one object:
//   format "voxweld-manifest", version 3
//   lattice      {step, bits, origin [x, y, z]}
//   border       "closed" or "open"; border_slack (output units, optional, 0): how far inside the
//                sample range a boundary edge of an open border may lie
//   topology     "safe": that of the surface before it was simplified, as simplify.topology =
//                "manifold" and "safe" both keep it; or "free"
//   labels       "each" or "shared"; absent where the surface is at an isovalue. shared: triangles
//                separate pairs of labels, which the mesh files name; each label's edges balance,
//                and the mesh is no 2-manifold where labels meet
//   frame        {size [x, y, z], spacing, unit, first, origin, direction [3][3], space}: sample i
//                lies at first + spacing * i in the files, and what lies at p there at origin +
//                direction * p in the world; first (optional, 0) is 0 but of crops and meshes
//   counts       {bricks, active_bricks, collapsed_above_bricks, leaves [per level], vertices,
//                quads and polygon_triangles (as stitched), triangles (of the mesh), tiles,
//                collinear, files, bytes (mesh files, those of the tiles included), labels (with "labels")};
//                vertices: of the octree, less those that refine took; with a closed border and
//                safe topology those of the welded mesh, else some of them are in no polygon
//   merged       {"drc": path, "glb": path ...}, by the name of the format, or null
//   files        [{path, format, role "list", "labels", "levels", "tileset", "pieces" or "merged", bytes, xxh3_128}]: the list of
//                tiles, that of labels, and the merged mesh; a tile's files are in its line
//   input, config, stages, error, refine, made_by   free-form; input: slope and intercept where they
//                are not 1 and 0 (real values are slope * stored + intercept); made_by: program, host, time,
//                Slurm ids
//                error: {metric, tolerance, reached (the largest of leaves above level 0), finest (of
//                level 0), levels [the largest of each level, as counts.leaves; 0 where it has no leaf],
//                unit}, of the octree as it is before refine
//                refine (unless simplify.refine is off): {mode, collapses, moves, flips, cubes (of all
//                passes), intersecting_before (the first pass), intersecting_left (after the last),
//                worst, p99 (distances of what the mesh was from what it is), unit}
//   levels (free-form, with output.levels): of each level of detail, the mesh itself first, {level,
//                tolerance (of collapsing edges), tiles, triangles, bytes, intersecting_left, worst, p99
//                (distances of what the mesh was; of coarser ones p99 at a sample of its points, and
//                worst both ways)}: of the whole mesh as it is at that level. bytes are of files that
//                it does not share with the level before
// tiles.jsonl, one object a line:
//   {label (with "labels" = "each"), tile {level, at [x, y, z]}, vertices, triangles, quads,
//    polygon_triangles, files [{format, path, bytes, xxh3_128}]}
//   of each label those of one stand together, and labels ascend. With "levels" that of a label in one
//   tile also has place {level, at}, a cube around the middle of its mesh
// levels.jsonl, with "levels", the same of the tiles of coarser levels, by height and in Morton order:
//   {lod (1 or more), tile, vertices, triangles, quads, polygon_triangles, files}
//   Such a tile stands for all tiles, of the mesh and of less height, whose cubes (places, if they have
//   some) lie in its own. Of equal cubes the one of more height stands for the other. With "labels" =
//   "each" it has meshes of many labels: each triangle separates its label from the exterior
// labels.jsonl, with "labels", one object a line, ascending:
//   {label, name (optional), color (optional, [r, g, b] of 0 .. 255), vertices, triangles,
//    volume (enclosed, output units; null with an open border), area, bounds [lo [x, y, z],
//    hi [x, y, z]] (null where the label has no triangle), tiles, files [path]}
//   vertices: as counts.vertices, of the label's octree. Volume, area and bounds are those of the
//   mesh as written: the volume is exact but for its last rounding, whatever the tiles.
//   Where labels are "shared" all these are of the label's boundary, the triangles that have it on
//   either side; vertices then counts those on seams once for each tile, and files is empty: every
//   file may have a part of it
// Paths are relative to the directory. Keys that are not listed are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/types/file_record.h"
#include "storage/types/material.h"
#include "storage/types/morton.h"
#include "storage/types/output_lattice.h"
#include "storage/types/volume.h"

namespace voxweld {

struct TileRecord {
  std::optional<Material> label;
  CellKey tile;
  std::uint64_t vertices = 0;   // of the tile's own mesh
  std::uint64_t triangles = 0;  // output triangles: 2 quads + polygon_triangles
  std::uint64_t quads = 0;
  std::uint64_t polygon_triangles = 0;
  std::vector<FileRecord> files;
  int lod = 0;  // of a coarser level of detail its height above the tiles of the mesh itself
  // Of a label in one tile, where there are levels of detail: where about it lies, in place of its tile.
  std::optional<CellKey> place = {};
  friend bool operator==(const TileRecord&, const TileRecord&) = default;
};

// One line of labels.jsonl.
struct LabelRecord {
  Material label = exterior;
  std::string name;  // empty: none
  std::optional<std::array<std::uint8_t, 3>> color;
  std::uint64_t vertices = 0, triangles = 0;
  std::optional<double> volume;
  double area = 0;
  struct Bounds {
    Vec3 lo, hi;
    friend bool operator==(const Bounds&, const Bounds&) = default;
  };
  std::optional<Bounds> bounds;
  std::uint64_t tiles = 0;
  std::vector<std::string> files;
  friend bool operator==(const LabelRecord&, const LabelRecord&) = default;
};

struct ManifestCounts {
  std::uint64_t bricks = 0, active_bricks = 0;
  std::uint64_t collapsed_above = 0;  // octree nodes above the bricks that took in their children
  std::vector<std::uint64_t> leaves;  // per level
  std::uint64_t vertices = 0;         // of the octree
  std::uint64_t quads = 0, polygon_triangles = 0;  // as stitched, before quads are cut
  std::uint64_t triangles = 0;                     // of the mesh
  std::uint64_t tiles = 0, collinear = 0;
  std::uint64_t files = 0, bytes = 0;  // of meshes
  std::uint64_t labels = 0;
  friend bool operator==(const ManifestCounts&, const ManifestCounts&) = default;
};

// Of each format that was written, by its name, the file's path.
using MergedFiles = std::map<std::string, std::string>;

struct Manifest {
  Manifest();
  ~Manifest();
  Manifest(Manifest&&) noexcept;
  Manifest& operator=(Manifest&&) noexcept;

  OutputLattice lattice;
  bool open_border = false;
  double border_slack = 0;
  bool free_topology = false;
  LabelMode labels = LabelMode::off;
  VolumeGeometry frame;
  ManifestCounts counts;
  std::optional<MergedFiles> merged;
  std::vector<FileRecord> files;
  // Free-form sections: null when absent.
  std::unique_ptr<nlohmann::json> input, config, stages, error, refine, levels, made_by;
};

inline constexpr const char* manifest_name = "manifest.json";
inline constexpr const char* tiles_name = "tiles.jsonl";
inline constexpr const char* labels_name = "labels.jsonl";
inline constexpr const char* levels_name = "levels.jsonl";
inline constexpr const char* tileset_name = "tileset.json";
inline constexpr const char* pieces_name = "tiles.pvtp";

void write_manifest(const Manifest& manifest, const std::filesystem::path& path,
                    Durability durability = Durability::fsync);
// FormatError naming path and key where it is not what is described above.
Manifest read_manifest(const std::filesystem::path& path);

// InputError where the directory is no output of a run: it has no manifest. A run of several
// isovalues makes an output directory for each in one folder; of that folder the message names them.
void require_output(const std::filesystem::path& directory);
// Those outputs: the names of folders in this one that have a manifest, sorted.
std::vector<std::string> outputs_within(const std::filesystem::path& directory);

// One line of tiles.jsonl, with its newline.
std::string to_json_line(const TileRecord& record);
// FormatError, starting with `where` (path and line number).
TileRecord parse_tile_record(const std::string& line, const std::string& where);

// The same of labels.jsonl.
std::string to_json_line(const LabelRecord& record);
LabelRecord parse_label_record(const std::string& line, const std::string& where);

// Streams a list, line by line.
template <class Record>
class ListReader {
 public:
  explicit ListReader(const std::filesystem::path& path);  // StorageError when it cannot open
  // The next record, or nothing at the end. FormatError naming path and line.
  std::optional<Record> next();

 private:
  std::string path_;
  std::ifstream stream_;
  std::uint64_t line_ = 0;
};
using TileListReader = ListReader<TileRecord>;
using LabelListReader = ListReader<LabelRecord>;

}  // namespace voxweld
