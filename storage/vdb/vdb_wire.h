// What passes between the program and the child process that OpenVDB works in: plain memory, which
// begins as zeros.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

inline constexpr std::size_t most_vdb_grids = 1000;
// Samples a side of the boxes that are read at once.
inline constexpr std::int64_t vdb_piece = 128;
inline constexpr std::size_t vdb_piece_samples = std::size_t{vdb_piece} * vdb_piece * vdb_piece;

// A grid as its header describes it. Texts end with a zero.
struct VdbGrid {
  char name[1000];
  char type[48];                   // of its values, as OpenVDB calls it: "float", "vec3s" ...
  char grid_class[48];             // "level set", "fog volume" ...
  char map[48];                    // what the transform is: "UniformScaleMap" ...
  std::int32_t sample;             // a SampleType; -1: none of ours
  bool half;                       // stored as floats of 16 bits
  bool linear;                     // `matrix` is the transform
  bool has_box;                    // the header tells the box
  std::int64_t first[3], last[3];  // of active voxels, both within
  double matrix[4][4];             // (i, j, k, 1) * matrix: the world's coordinates
};

enum class VdbTask : std::uint32_t { survey, open, read };

struct VdbTalk {
  VdbTask task;
  // survey: no more to say. It sets grids, and tells of the file what the refusals need.
  std::uint32_t grids;
  std::uint64_t file_bytes, needed_bytes;
  VdbGrid grid[most_vdb_grids];
  // open: which one. It sets what follows.
  std::uint32_t chosen;
  bool active;                     // there is an active voxel
  std::int64_t first[3], last[3];  // of active voxels, both within
  std::uint64_t tree_bytes;        // that the child keeps
  // read: at most vdb_piece samples a side, of indices of the grid. It sets samples, x fastest.
  Box3 box;
  std::byte samples[vdb_piece_samples * 8];
};

}  // namespace voxweld
