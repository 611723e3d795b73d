#include "stages/build/cell_planes.h"

namespace voxweld {

void gather_planes(LocalCell c, const CellSheets& sheets, int sheet, const HermiteEdges& edges,
                   Vec3 spacing, SheetPlanes& out) {
  out.count = 0;
  for (std::size_t i = 0; i < sheets.crossings; ++i) {
    const int e = sheets.edges[i];
    if (sheet != all_sheets && sheets.sheet_of_edge[static_cast<std::size_t>(e)] != sheet) continue;
    const int axis = e >> 2, low = edge_corners(e).low;
    const int x = low & 1, y = low >> 1 & 1, z = low >> 2;
    const HermiteEdge& edge = edges.at(axis, c.x + x, c.y + y, c.z + z);
    const double end[3] = {x - 0.5, y - 0.5, z - 0.5};
    const std::size_t k = out.count++;
    HermitePlane& plane = out.all_planes[k];
    plane.weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      plane.normal[a] = static_cast<double>(edge.normal[a]);
      plane.point[a] = end[a] * spacing[static_cast<int>(a)];
    }
    plane.point[static_cast<std::size_t>(axis)] =
        (static_cast<double>(edge.t) - 0.5) * spacing[axis];
    out.all_normals[k] = edge.normal;
  }
}

Vec3 node_centre(const BrickFrame& frame, int level, std::uint32_t code, Vec3 spacing) {
  const LocalCell c = decode_local(code);
  Vec3 centre;
  for (int a = 0; a < 3; ++a) {
    const double side = static_cast<double>(std::int64_t{1} << level);
    centre[a] = (static_cast<double>(frame.origin[a]) + (c[a] + 0.5) * side - 1) * spacing[a];
  }
  return centre;
}

}  // namespace voxweld
