// What a file or a directory is, as a document: every kind of input volume, and everything a run
// leaves behind.
//
// The document is one JSON object. Keys of every kind: "kind" and "path"; of files and directories
// of ours "bytes". With `check`, "check": {files, bytes (read), damaged [{path, what}]}.
// Sizes, indices and boxes are [x, y, z]; hashes are 32 hexadecimal digits.
//
//   kind             further keys
//   volume           format, size, type, slope, intercept (where real values are slope * stored +
//                    intercept and these are not 1 and 0), surface {isovalue, inside} (where the
//                    file itself says that it has one), samples, sample_bytes (of all), spacing,
//                    unit, origin, direction [3][3], space, access, largest_decode_bytes, files,
//                    file_bytes, choices [{selector, value, text, chosen}] (where the input holds
//                    several volumes), warnings, values; verbose: file_list [{path, bytes}]; of Zarr
//                    and N5 also zarr {chunk, file, compression}
//   brick_store      as volume, and records, chunk, shard, compression, shards {total, present};
//                    verbose: shard_list [{at, bytes, range}]
//   octree           key, content_hash, version, made_by, input_hash, bricks, active_bricks,
//                    active_cells, crossing_edges, vertices, collapsed_above, worst_residual,
//                    leaves, errors (the largest; both by level), pieces, nodes (counts, of all
//                    materials together); verbose: piece_list [{material (a label with labels.mode =
//                    "each", else 0), brick, vertices, polygons, ghost_cells, bytes}]
//   top_tree         key, content_hash, version, made_by, bricks, active_bricks, active_cells,
//                    crossing_edges, vertices, collapsed_above, top_leaves, worst_residual, leaves,
//                    errors (both by level), materials (labels with labels.mode = "each", else 1),
//                    tiles, batches (stitch's units); verbose: batch_list [{material (the first),
//                    materials, level, at (of the first tile), tiles, vertices, polygons}]
//   tile             key, content_hash, version, made_by, level, at, vertices, triangles, quads,
//                    polygon_triangles, collinear, lattice {step, bits, origin}; with labels.mode =
//                    "each" in place of these meshes [{label, level, at, vertices, triangles}]
//   cube_mesh        (of refine) key, content_hash, version, made_by, cubes (with triangles),
//                    vertices (once for each part that has them), triangles, leaving_triangles (of
//                    those, with corners in several cubes), samples, box {lo, hi} (lattice points,
//                    where there are triangles), refined {cubes, collapses, moves, flips,
//                    intersecting_before, intersecting_left, worst_steps}; verbose: cube_list [{at,
//                    triangles (inside), leaving_triangles, samples}]
//   tile_plan        (of refine) key, content_hash, version, made_by, made_of (meshes), and as of a
//                    top_tree materials, tiles, batches; verbose: batch_list
//   asset_record     key, vertices, triangles, quads, polygon_triangles, collinear, files [{path,
//                    format, bytes, xxh3_128}]; with labels.mode = "each" labels
//   histogram        key, type, values
//   label_counts     key, content_hash, labels
//   mesh_record      key, content_hash (of the mesh's file), vertices, triangles (with three
//                    corners that differ), bounds {lo, hi}
//   mesh_bins        key, bricks {outside, inside, reached (by a triangle)}, triangles (in all)
//   mesh_table       key, shards {outside, inside, reached}, bricks (reached), triangles,
//                    largest {brick, triangles}
//   shard_record     key, array, at, shard_bytes, shard_hash, values
//   spool_record     key, data_hash, and the volume's keys
//   zarr_chunk       array
//   mesh             format, points, vertices (distinct positions), triangles, normals, bounds {lo,
//                    hi} (as in the file)
//   input_mesh       format, vertices (distinct positions), triangles, bounds {lo, hi}, size,
//                    volume (what it encloses; negative where its triangles face inward), closed,
//                    boundary_edges (of an odd number of triangles), holes, hole_list [{edges,
//                    size, center}] (the largest first: verbose all of them, else ten)
//   output           border, topology, frame, lattice, counts, files {count, bytes}, merged, error,
//                    refine (unless it is off), input (as manifest.json has them); verbose: file_list
//   tile_list        tiles, vertices, triangles, files, file_bytes; verbose: tile_list
//   label_list       labels, tiles, vertices, triangles, volume, area (sums); verbose: label_list
//                    [{label, name, triangles, volume, area}]
//   pieces           (tiles.pvtp, the .vtp tiles as one mesh)
//   neuroglancer_export  (a folder) files, format "multilod_draco" or "legacy", sharded, border
//                    "open" or "closed", objects, levels [{level, objects, fragments, bytes}];
//                    verbose: object_list [{object, levels, fragments, bytes}]
//   viewer_folder    (a folder of `voxweld view --export`) files, shown: the name of the run or file
//   report           (report.html, a page about a run)
//   config           settings {table {key: value}}
//   temporary        of: the file it would have become
//   work_directory   files, stages [{stage, folder, files, bytes}]
//   stage_directory  stage, files
//
// "values", where the samples were looked at, in real values (of the kind histogram, as stored):
// {samples, nan_samples, range [lo, hi], quantiles {"1%" ... "99%"}, bins, suggested_isovalue
// {value, separability, padding} or null}.
// "labels", where they were counted: {distinct, negative_samples, range [lo, hi], background_share
// (of label 0), largest [{label, samples, share, from, to (the box that holds them, half-open)}]}.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/info/value_scan.h"
#include "storage/readers/open_volume.h"

namespace voxweld {

using InfoDocument = nlohmann::ordered_json;

struct InfoOptions {
  InputSpec input;         // the path, and how to read it where it is headerless
  bool check = false;      // read everything and compare it with its checksums
  bool histogram = false;  // look at the samples of a volume however many there are
  bool labels = false;     // count the labels of a volume
  bool verbose = false;    // lists of bricks, tiles, shards, files
  ScanHooks hooks;
};

// InputError where there is nothing; FormatError where it is nothing that is known (the message
// lists what is) or a single file is damaged.
InfoDocument describe(const InfoOptions& options);

// Whether `check` found damage.
bool found_damage(const InfoDocument& document);

std::string to_text(const InfoDocument& document);
std::string to_json_text(const InfoDocument& document);

}  // namespace voxweld
