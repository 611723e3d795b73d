// Surfaces of random volumes, as refine takes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "stages/refine/refine_range.h"
#include "stages/refine/retile.h"
#include "stages/stitch/lattice_plan.h"
#include "tests/support/contour_in_memory.h"

namespace voxweld::testing {

struct RandomVolume {
  std::int64_t side = 24;
  bool noise = false;  // else a smooth field
  unsigned seed = 0;
};

inline MemoryVolume volume_of(const RandomVolume& wanted) {
  std::mt19937 random(wanted.seed);
  if (wanted.noise) {
    std::normal_distribution<float> normal;
    return MemoryVolume::made<float>(splat(wanted.side), SampleType::f32,
                                     [&](Index3) { return normal(random); });
  }
  struct Wave {
    Vec3 way;
    double phase, height;
  };
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Wave> waves(12);
  for (Wave& wave : waves)
    wave = {Vec3{unit(random), unit(random), unit(random)} * 0.8, 3 * unit(random), unit(random)};
  return MemoryVolume::made<float>(splat(wanted.side), SampleType::f32, [&](Index3 at) {
    const Vec3 p{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
    double sum = 0;
    for (const Wave& wave : waves) sum += wave.height * std::cos(dot(wave.way, p) + wave.phase);
    return static_cast<float>(sum);
  });
}

struct VolumeMesh {
  RefineMesh mesh;
  RefineFrame frame;
};
inline VolumeMesh mesh_of(const MemoryVolume& volume, ContourParameters parameters) {
  parameters.simplify.overhang = 1;
  const VolumeContour contour = contour_volume(volume, parameters);
  const OutputLattice lattice = plan_lattice({volume.size, {1, 1, 1}, 0.01});
  // One tile: so small a volume has no more. (join_tiles would lose the vertices' aims.)
  return {to_refine_mesh(contour.tiles.at(0)), {lattice, {1, 1, 1}, {}, volume.size}};
}
inline VolumeMesh mesh_of(const MemoryVolume& volume, double tolerance) {
  ContourParameters parameters;
  parameters.surface.isovalue = {0.0};
  parameters.surface.gradient = Gradient::subcell;
  parameters.simplify.tolerance = tolerance;
  return mesh_of(volume, parameters);
}
inline VolumeMesh mesh_of_volume(const RandomVolume& wanted, double tolerance) {
  return mesh_of(volume_of(wanted), tolerance);
}

inline RefineParameters refining(const RefineFrame& frame, double tolerance, RefineMode mode) {
  RefineParameters refine;
  refine.mode = mode;
  refine.tolerance = tolerance / frame.lattice.step;
  refine.reach = 1 / frame.lattice.step;
  return refine;
}

// As the passes of a run have them.
inline RefineParameters of_pass(int pass, RefineParameters refine) {
  if (pass == 2) refine.mode = RefineMode::mend;
  return refine;
}

}  // namespace voxweld::testing
