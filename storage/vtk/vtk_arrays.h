// What the two formats of VTK for images have in common: arrays at the points or in the cells of a
// lattice, of which one is read.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/volume_reader.h"

namespace voxweld {

struct VtkArray {
  std::string name;
  bool of_cells = false;             // one value a cell between points; else one a point
  std::string type_name;             // as the file has it
  std::optional<SampleType> type{};  // empty where it is none of ours
  std::int64_t components = 1;
};

// The points of the file.
struct VtkLattice {
  Index3 size;                                  // points a side
  Vec3 spacing{1, 1, 1}, origin{0, 0, 0};       // origin: of point (0, 0, 0), which may be far off
  Vec3 first{0, 0, 0};                          // index of the first point that is there
  std::array<Vec3, 3> direction{Vec3{1, 0, 0},  // direction[a]: of axis a in the world
                                Vec3{0, 1, 0}, Vec3{0, 0, 1}};
};

// Which of the arrays is meant: the one of input.dataset ("NAME", "cells/NAME"), the one that the
// file marks as its scalars (`marked_points`, `marked_cells`; empty: none), or the only one. The
// others go to info.choices.
// InputError where several are left, and none of that name; FormatError where there is none at all,
// or the one has several values a sample, or values of a type that is none of ours.
std::size_t choose_vtk_array(const std::vector<VtkArray>& arrays, const std::string& marked_points,
                             const std::string& marked_cells, const InputSpec& spec,
                             VolumeInfo& info);

// Size and place of the samples: of values in cells, the cells' middles. where: for messages.
// FormatError where the axes are none.
void place_vtk_samples(const VtkLattice& lattice, const VtkArray& array, const std::string& where,
                       VolumeInfo& info);

}  // namespace voxweld
