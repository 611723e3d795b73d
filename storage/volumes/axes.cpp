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

std::string canonical_unit(std::string_view text) {
  const std::string name = lower(trim(text));
  for (const auto& spellings : unit_spellings)
    if (!name.empty() && std::ranges::find(spellings, name) != spellings.end())
      return std::string(spellings[0]);
  return std::string(trim(text));
}

}  // namespace voxweld
