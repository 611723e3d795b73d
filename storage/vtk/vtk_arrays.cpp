#include "storage/vtk/vtk_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"
#include "storage/volumes/array_choice.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

std::string selector_of(const VtkArray& array) {
  return array.of_cells ? "cells/" + array.name : array.name;
}

// The marked array of the points or the cells.
std::optional<std::size_t> marked_array(const std::vector<FileArray>& arrays, bool of_cells,
                                        const std::string& name) {
  if (name.empty()) return {};
  const auto found =
      std::ranges::find(arrays, of_cells ? "cells/" + name : name, &FileArray::selector);
  if (found == arrays.end()) return {};
  return static_cast<std::size_t>(found - arrays.begin());
}

// Of points before cells; of each the marked one before the only one.
std::optional<std::size_t> preferred_array(const std::vector<VtkArray>& arrays,
                                           const std::vector<FileArray>& listed,
                                           const std::string& marked_points,
                                           const std::string& marked_cells) {
  for (const bool of_cells : {false, true}) {
    if (std::ranges::find(arrays, of_cells, &VtkArray::of_cells) == arrays.end()) continue;
    if (const auto found = marked_array(listed, of_cells, of_cells ? marked_cells : marked_points))
      return found;
    std::vector<FileArray> here = listed;
    for (std::size_t i = 0; i < arrays.size(); ++i)
      if (arrays[i].of_cells != of_cells) here[i].type.reset();
    if (const auto only = only_readable(here)) return only;
    if (std::ranges::any_of(here, [](const FileArray& a) { return a.type && a.components == 1; }))
      return {};
  }
  return {};
}

}  // namespace

std::size_t choose_vtk_array(const std::vector<VtkArray>& arrays, const std::string& marked_points,
                             const std::string& marked_cells, const InputSpec& spec,
                             VolumeInfo& info) {
  std::vector<FileArray> listed;
  for (const VtkArray& array : arrays)
    listed.push_back({.selector = selector_of(array),
                      .type_name = array.type_name,
                      .type = array.type,
                      .components = array.components,
                      .place = array.of_cells ? "in cells" : "at points"});
  return choose_array(listed, preferred_array(arrays, listed, marked_points, marked_cells), spec,
                      info);
}

void place_vtk_samples(const VtkLattice& lattice, const VtkArray& array, const std::string& where,
                       VolumeInfo& info) {
  VolumeGeometry& geometry = info.geometry;
  std::array<Vec3, 3> steps;
  Vec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    spacing[axis] = sound_spacing(lattice.spacing[axis],
                                  fmt::format("{}: Spacing, axis {}", where, axis), info);
    steps[a] = lattice.direction[a] * spacing[axis];
  }
  set_axes(info, steps, where + ": Direction");
  geometry.size = lattice.size;
  geometry.origin = lattice.origin;
  for (int axis = 0; axis < 3; ++axis) {
    // As written, where it comes back from the matrix but for the last digit.
    if (std::abs(geometry.spacing[axis] / spacing[axis] - 1) < 1e-9)
      geometry.spacing[axis] = spacing[axis];
    double index = lattice.first[axis];
    if (array.of_cells && lattice.size[axis] > 1) {
      index += 0.5;
      --geometry.size[axis];
    }
    geometry.origin = geometry.origin + steps[static_cast<std::size_t>(axis)] * index;
  }
  if (!std::isfinite(length(geometry.origin)))
    throw FormatError(where + ": the origin is not finite: correct the header");
  if (array.of_cells)
    info.warnings.push_back(fmt::format(
        "{}: '{}' has a value for each cell: read as samples in the middle of cells, half a "
        "spacing behind the points and one fewer along each axis",
        where, array.name));
}

}  // namespace voxweld
