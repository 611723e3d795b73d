// From what headers say about the axes to VolumeGeometry: spacing, directions, units.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "storage/types/volume.h"

namespace voxweld {

double length(Vec3 v);

// Sets spacing and direction from the world vectors one sample step along x, y and z makes
// (direction times spacing). FormatError "<where>: ..." when one is zero or not finite, or when
// they lie in a plane; warns when they are not perpendicular.
void set_axes(VolumeInfo& info, const std::array<Vec3, 3>& steps, const std::string& where);

// What a header says of a spacing, as all readers take it: of a negative one the magnitude; 0 and
// what is not finite stand for 1. Both are a warning "<where>: ...".
double sound_spacing(double spacing, const std::string& where, VolumeInfo& info);

// What a header says of real values: slope * stored + intercept. A slope of 0 is how formats say
// nothing. Numbers that are not finite say nothing either, with a warning.
ValueScale sound_scale(double slope, double intercept, const std::string& where, VolumeInfo& info);

// InputError "<where>: ..." where the output's floats cannot hold coordinates of such a volume.
void check_coordinates(const VolumeGeometry& geometry, const std::string& where);

// "mm" for "millimeter", "Millimetres", "mm" ...; other texts stay as they are.
std::string canonical_unit(std::string_view text);

}  // namespace voxweld
