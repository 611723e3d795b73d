// What a VTI file (VTK XML ImageData) says about itself.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/vtk/block_run.h"
#include "storage/vtk/vtk_arrays.h"

namespace voxweld {

enum class VtiFormat : std::uint8_t { ascii, binary, appended };

struct VtiArray {
  VtkArray array;
  VtiFormat format = VtiFormat::ascii;
  // Of ascii and binary: where the text lies; both 0 where there is none. Of appended data: where
  // it begins.
  std::uint64_t begin = 0, end = 0;
};

struct VtiHeader {
  VtkLattice lattice;
  std::vector<VtiArray> arrays;  // at points, then in cells
  std::string marked_points, marked_cells;
  WordForm words;  // also the byte order of the samples
  std::optional<BlockCodec> codec{};
  bool appended_is_base64 = false;
  std::vector<std::string> warnings;
};

// FormatError for what is no file of one image of three dimensions, in one piece.
VtiHeader read_vti_header(const ReadFile& file);

}  // namespace voxweld
