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

// "mm" for "millimeter", "Millimetres", "mm" ...; other texts stay as they are.
std::string canonical_unit(std::string_view text);

}  // namespace voxweld
