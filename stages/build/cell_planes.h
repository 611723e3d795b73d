// The Hermite data of one sheet of one cell as QEF planes and normals.
#pragma once

#include "stages/build/brick_nodes.h"
#include "stages/contouring/normal_clusters.h"

namespace voxweld {

struct SheetPlanes {
  std::array<HermitePlane, max_planes> all_planes;
  std::array<NormalSum, max_planes> all_normals;  // each as often as it weighs
  std::size_t count = 0;
  std::span<const HermitePlane> planes() const { return {all_planes.data(), count}; }
  std::span<const NormalSum> normals() const { return {all_normals.data(), count}; }
};

inline constexpr int all_sheets = -1;

// The planes of `sheet` (or of all_sheets) of the cell at c, in edge order, relative to its centre.
void gather_planes(LocalCell c, const CellSheets& sheets, int sheet, const HermiteEdges& edges,
                   Vec3 spacing, SheetPlanes& out);

// Centre of a node of `level` at local Morton `code` (in its level's units), in the volume's frame
// spacing * sample index.
Vec3 node_centre(const BrickFrame& frame, int level, std::uint32_t code, Vec3 spacing);

}  // namespace voxweld
