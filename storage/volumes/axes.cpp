#include "storage/volumes/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

// Directions that are perpendicular but for the digits they were written with.
constexpr double perpendicular_tolerance = 1e-3;
constexpr double flat_tolerance = 1e-6;
// Floats hold numbers from 1e-38 to 3e38. This leaves room for the steps a spacing is cut into, and
// for differences of coordinates.
constexpr double largest_coordinate = 1e36, least_spacing = 1e-30;

// Each with its spellings behind it.
constexpr std::array<std::array<std::string_view, 9>, 6> unit_spellings = {{
    {"m", "meter", "metre", "meters", "metres"},
    {"cm", "centimeter", "centimetre", "centimeters", "centimetres"},
    {"mm", "millimeter", "millimetre", "millimeters", "millimetres"},
    {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "microns", "micrometer", "micrometre", "micrometers",
     "micrometres"},
    {"nm", "nanometer", "nanometre", "nanometers", "nanometres"},
    {"in", "inch", "inches"},
}};

}  // namespace

double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}

void set_axes(VolumeInfo& info, const std::array<Vec3, 3>& steps, const std::string& where) {
  VolumeGeometry& geometry = info.geometry;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = steps[static_cast<std::size_t>(axis)];
    const double spacing = length(step);
    if (!std::isfinite(spacing) || spacing <= 0)
      throw FormatError(
          fmt::format("{}: the step along axis {} is ({}, {}, {}): it must be finite and not zero: "
                      "correct the header or state the spacing",
                      where, axis, step.x, step.y, step.z));
    geometry.spacing[axis] = spacing;
    geometry.direction[static_cast<std::size_t>(axis)] = step * (1 / spacing);
  }
  const auto& d = geometry.direction;
  if (std::abs(dot(d[0], cross(d[1], d[2]))) < flat_tolerance)
    throw FormatError(where + ": the three axis directions lie in one plane: correct the header");
  const double skew =
      std::max({std::abs(dot(d[0], d[1])), std::abs(dot(d[1], d[2])), std::abs(dot(d[2], d[0]))});
  if (skew > perpendicular_tolerance)
    info.warnings.push_back(
        fmt::format("{}: the axes are not perpendicular (cosine {:.4f}): contouring measures "
                    "distances as if they were, the output transform is exact",
                    where, skew));
}

double sound_spacing(double spacing, const std::string& where, VolumeInfo& info) {
  if (spacing > 0 && std::isfinite(spacing)) return spacing;
  const double taken = spacing != 0 && std::isfinite(spacing) ? -spacing : 1;
  info.warnings.push_back(
      fmt::format("{}: a spacing of {} is taken as {}: correct the header or set the spacing if "
                  "that is wrong",
                  where, spacing, taken));
  return taken;
}

ValueScale sound_scale(double slope, double intercept, const std::string& where, VolumeInfo& info) {
  if (!std::isfinite(slope) || (slope != 0 && !std::isfinite(intercept)))
    info.warnings.push_back(fmt::format(
        "{}: a scaling of values by {} * stored + {} is not finite: values are taken as stored",
        where, slope, intercept));
  return value_scale(slope, intercept);
}

void check_coordinates(const VolumeGeometry& geometry, const std::string& where) {
  const Vec3 s = geometry.spacing, o = geometry.origin, f = geometry.first;
  double largest = 0;
  bool sound = true;
  const auto look = [&](double value) {
    sound = sound && std::isfinite(value);
    largest = std::max(largest, std::abs(value));
  };
  for (int a = 0; a < 3; ++a) {
    look(o[a]);
    look(f[a]);
    look(static_cast<double>(geometry.size[a] + 1) * s[a]);
  }
  if (!sound || largest > largest_coordinate)
    throw InputError(
        fmt::format("{}: the coordinates reach {:.3g}, but those of meshes are floats and may "
                    "reach {:g} (spacing "
                    "{:g} x {:g} x {:g}, origin {:g}, {:g}, {:g}): give lengths in a larger unit",
                    where, largest, largest_coordinate, s.x, s.y, s.z, o.x, o.y, o.z));
  if (const double least = std::min({s.x, s.y, s.z}); !(least >= least_spacing))
    throw InputError(
        fmt::format("{}: the spacing is {:g} x {:g} x {:g}, but coordinates of meshes are floats, "
                    "which can tell "
                    "apart samples {:g} apart or more: give lengths in a smaller unit",
                    where, s.x, s.y, s.z, least_spacing));
}

std::string canonical_unit(std::string_view text) {
  const std::string name = lower(trim(text));
  for (const auto& spellings : unit_spellings)
    if (!name.empty() && std::ranges::find(spellings, name) != spellings.end())
      return std::string(spellings[0]);
  return std::string(trim(text));
}

}  // namespace voxweld
