// What each stage after ingest is asked to do: plain data, wired to each other by pipeline/run.
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "pipeline/config/settings.h"
#include "pipeline/stage/shard_memory.h"
#include "pipeline/stage/volume.h"
#include "stages/contouring/brick_grid.h"
#include "stages/contouring/parameters.h"
#include "stages/encode/mesh_writers.h"
#include "stages/refine/mend_boxes.h"
#include "stages/refine/refine_range.h"
#include "stages/solids/solid.h"
#include "stages/stitch/tile_stitcher.h"
#include "storage/support/hash.h"
#include "storage/types/material_table.h"

namespace voxweld {

// Of a mesh as the input that lies in pieces on disk: the largest of them.
struct LargestBin {
  std::uint64_t bytes = 0, triangles = 0;
  std::uint64_t index_bytes = 0;  // of the shards' files that are open at once
};

struct BuildJob {
  Volume volume;
  BrickGrid grid;
  ContourParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
  ShardMemory memory = {};
  // Part of the brick store could not be made: shards that would read it are left out.
  bool partial_input = false;
  LargestBin largest_bin = {};
  // The same but for a smaller tolerance: where its octrees are there, these are cuts of them, and no
  // sample is read. It outlives this.
  const BuildJob* finer = nullptr;
  bool finer_may_fail = false;  // samples are read where one of these octrees is damaged
  // Where ranges of bricks are kept, whatever is built from them; empty: nowhere.
  std::filesystem::path ranges = {};
};

struct MergeJob {
  const BuildJob* build = nullptr;
  std::filesystem::path folder;
  Hash128 key;  // of the parameters; the artifact also says which octrees it was merged from
  std::uint64_t tile_vertices = 250000;

  std::filesystem::path path() const { return folder / "top.tree"; }
};

struct StitchJob {
  const BuildJob* build = nullptr;
  const MergeJob* merge = nullptr;
  StitchParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
  // Where the mesh is refined: it leaves no tiles, but meshes that are sorted by these cubes.
  std::optional<RefineFrame> cubes = {};
};

// How many triangles are to be left.
struct CollapseTarget {
  std::optional<std::uint64_t> triangles;
  double ratio = 1;  // of those that there are, where no number is given

  std::uint64_t of(std::uint64_t there) const {
    return triangles ? *triangles
                     : static_cast<std::uint64_t>(std::llround(ratio * static_cast<double>(there)));
  }
};

// One pass of refine, or what its tolerance is chosen by.
struct RefineJob {
  Stage stage = Stage::refine;  // or seams or mend; survey and recount before the first two
  int pass = 0;                 // of CubeLattice
  int next = 1;                 // the pass that takes what it leaves; 0: retile
  RefineFrame frame;
  // With a target the tolerance is known once what it is chosen by is there: of recount it is that of
  // refine, of survey there is none.
  RefineParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
  std::optional<CollapseTarget> target = {};
  MendRoom room = {};  // of mend

  std::filesystem::path tolerance_path() const { return folder / "tolerance"; }
};

struct RetileJob {
  RefineFrame frame;
  OutputLattice lattice;  // of the tiles, as the files have it
  std::uint64_t tile_vertices = 250000;
  bool normals = true;  // of the tiles
  std::filesystem::path folder;
  Hash128 key;  // of the parameters; the plan also says which meshes it was made of

  std::filesystem::path plan_path() const { return folder / "tile.plan"; }
};

// The coarser levels of detail.
struct LevelsJob {
  RefineFrame frame;
  RefineParameters parameters;  // of the mesh itself; the tolerance as the last pass has it
  OutputLattice lattice;        // of the files
  bool normals = true;          // of the files
  std::int64_t levels = 1;      // as output.levels; 0: until one tile holds all
  std::filesystem::path folder;
  Hash128 key;
};

struct EncodeJob {
  const StitchJob* stitch = nullptr;
  VolumeGeometry frame;
  std::filesystem::path folder;  // of the sidecar records
  std::filesystem::path output;
  Hash128 key;
  const MaterialTable* materials = nullptr;  // for the list of labels, and files that describe them
  bool describes = false;                    // there are such files
  std::vector<MeshWriter> formats = {};      // to write, in this order
  // Of the merged mesh only the triangles that reach into it, in the coordinates of the files.
  std::optional<Bounds> box = {};
  std::filesystem::path refined = {};  // folder of retile's tiles; empty: they are stitch's
};

}  // namespace voxweld
