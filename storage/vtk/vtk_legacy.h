// The header of a file of VTK's older format, and where its arrays lie.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/vtk/vtk_arrays.h"

namespace voxweld {

struct LegacyArray {
  VtkArray array;
  std::uint64_t begin = 0, end = 0;  // of its values in the file
  double slope = 1;                  // real values are the stored ones times that
};

struct LegacyHeader {
  bool text = false;  // else binary, big-endian
  VtkLattice lattice;
  std::vector<LegacyArray> arrays;          // at points and in cells, in the order of the file
  std::string marked_points, marked_cells;  // the first scalars of each
  std::vector<std::string> warnings;
};

// Reads through the file from array to array: of text all of it, piece by piece. FormatError for
// what is no data set of STRUCTURED_POINTS, damaged or truncated.
LegacyHeader read_vtk_legacy(const ReadFile& file);

}  // namespace voxweld
