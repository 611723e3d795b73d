#include "storage/vtk/vtk_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

constexpr std::size_t most_listed = 100;

std::string selector_of(const VtkArray& array) {
  return array.of_cells ? "cells/" + array.name : array.name;
}

std::string listed_arrays(const std::vector<VtkArray>& arrays) {
  std::string text;
  for (std::size_t i = 0; i < std::min(arrays.size(), most_listed); ++i)
    text += fmt::format(
        "{}'{}' ({}{})", i == 0 ? "" : ", ", selector_of(arrays[i]), arrays[i].type_name,
        arrays[i].components == 1 ? std::string()
                                  : fmt::format(", {} components", arrays[i].components));
  if (arrays.size() > most_listed) text += ", ...";
  return text;
}

std::optional<std::size_t> named_array(const std::vector<VtkArray>& arrays,
                                       const std::string& selector) {
  const auto found = std::ranges::find(arrays, selector, selector_of);
  if (found == arrays.end()) return {};
  return static_cast<std::size_t>(found - arrays.begin());
}

// The only array that holds volumes, of points first.
std::optional<std::size_t> only_array(const std::vector<VtkArray>& arrays) {
  for (const bool of_cells : {false, true}) {
    std::optional<std::size_t> only;
    std::size_t count = 0;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      if (arrays[i].of_cells != of_cells || arrays[i].components != 1 || !arrays[i].type) continue;
      only = i;
      ++count;
    }
    if (count == 1) return only;
    if (count > 1) return {};
  }
  if (arrays.size() == 1) return 0;  // to be refused for what it is
  return {};
}

std::optional<std::size_t> marked_array(const std::vector<VtkArray>& arrays, bool of_cells,
                                        const std::string& name) {
  if (name.empty()) return {};
  return named_array(arrays, of_cells ? "cells/" + name : name);
}

std::size_t settle_array(const std::vector<VtkArray>& arrays, const std::string& marked_points,
                         const std::string& marked_cells, const InputSpec& spec, VolumeInfo& info) {
  if (spec.select.has(Selector::dataset)) {
    if (const auto found = named_array(arrays, spec.select.dataset)) return *found;
    throw InputError(
        fmt::format("{}: no array '{}': there are {}; correct input.dataset or "
                    "--dataset",
                    spec.path, spec.select.dataset, listed_arrays(arrays)));
  }
  if (const auto found = marked_array(arrays, false, marked_points)) return *found;
  if (const auto found = only_array(arrays)) return *found;
  const bool any_of_points = std::ranges::find(arrays, false, &VtkArray::of_cells) != arrays.end();
  if (const auto found = marked_array(arrays, true, marked_cells); found && !any_of_points)
    return *found;
  if (!spec.survey)
    throw InputError(
        fmt::format("{}: the file has {} arrays: {}; choose one: set input.dataset or --dataset",
                    spec.path, arrays.size(), listed_arrays(arrays)));
  info.warnings.push_back(
      fmt::format("{}: the first of {} arrays is shown: choose one: set input.dataset or --dataset",
                  spec.path, arrays.size()));
  return 0;
}

}  // namespace

std::size_t choose_vtk_array(const std::vector<VtkArray>& arrays, const std::string& marked_points,
                             const std::string& marked_cells, const InputSpec& spec,
                             VolumeInfo& info) {
  if (arrays.empty())
    throw FormatError(fmt::format(
        "{}: no array of values at points or in cells: there is nothing to read", spec.path));
  const std::size_t chosen = settle_array(arrays, marked_points, marked_cells, spec, info);
  if (arrays.size() > 1)
    for (std::size_t i = 0; i < arrays.size(); ++i)
      info.choices.push_back(
          {.selector = selector_name(Selector::dataset),
           .value = selector_of(arrays[i]),
           .text = fmt::format("{}, {} component{}, {}", arrays[i].type_name, arrays[i].components,
                               arrays[i].components == 1 ? "" : "s",
                               arrays[i].of_cells ? "in cells" : "at points"),
           .chosen = i == chosen});
  const VtkArray& array = arrays[chosen];
  if (array.components != 1)
    throw FormatError(fmt::format(
        "{}: array '{}' has {} values a sample: vectors and colours are not supported, extract one "
        "component first{}",
        spec.path, array.name, array.components,
        arrays.size() > 1 ? ", or choose another array with input.dataset or --dataset" : ""));
  if (!array.type)
    throw FormatError(
        fmt::format("{}: array '{}' has values of type {}: expected integers of 8 to 64 bits or "
                    "floats of 32 or 64: convert the file first",
                    spec.path, array.name, array.type_name));
  return chosen;
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
