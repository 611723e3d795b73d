// How much a mesh on the output lattice holds and how large its surface is, in lattice steps.
#pragma once

#include <span>

#include "storage/types/mesh_measure.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

MeshMeasure measure(std::span<const LatticePoint> positions,
                    std::span<const std::array<std::uint32_t, 3>> triangles);

// In output units: volume6 / 6 and area2 / 2.
double enclosed_volume(const MeshMeasure& measure, const OutputLattice& lattice);
double surface_area(const MeshMeasure& measure, const OutputLattice& lattice);

}  // namespace voxweld
