// Pictures of tile meshes with the edges of their polygons.
#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/output/render.h"
#include "storage/types/tile_mesh.h"

namespace voxweld::paper {

// The triangles with the normals their corners take.
DecodedMesh shaded(const TileMesh& mesh);

// Dark ribbons along the polygons' edges, `width` wide in output units, lying on the polygons. The
// diagonal a quad is cut along is no edge.
DecodedMesh edges_of_polygons(const TileMesh& mesh, double width);

struct Drawing {
  RenderOptions options;
  double edge_width = 0;  // 0: none are drawn
};
void draw(const std::vector<TileMesh>& tiles, const Drawing& drawing,
          const std::filesystem::path& png);

}  // namespace voxweld::paper
