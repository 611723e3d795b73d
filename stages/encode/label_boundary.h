// The labels of a mesh between labels.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/encode/mesh_measure.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// The boundary of one label: all triangles that have it on either side, turned so that they face
// out of it.
struct LabelBoundary {
  Material label = exterior;
  std::uint64_t vertices = 0, triangles = 0;
  MeshMeasure measure;
};

// Of every label but `exterior`, ascending.
std::vector<LabelBoundary> measure_labels(const TileMesh& mesh);

}  // namespace voxweld
