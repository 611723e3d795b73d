// Surfaces of random volumes, as refine takes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "stages/refine/box_refiner.h"
#include "stages/refine/mend_box.h"
#include "stages/refine/mend_boxes.h"
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
inline VolumeMesh mesh_of(const MemoryVolume& volume, double tolerance,
                          Topology topology = Topology::safe) {
  ContourParameters parameters;
  parameters.simplify.topology = topology;
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

// What mend makes of a mesh that both passes have left.
inline RefineMesh mended(const RefineMesh& mesh, const RefineFrame& frame, RefineParameters refine,
                         RefineCounts& counts) {
  refine.mode = RefineMode::mend;
  const CubeLattice cubes(frame, refine_passes - 1);
  std::map<std::uint64_t, std::uint64_t> around;
  const auto cube_of = [&](std::size_t t) { return morton_encode(home_of(mesh, t, cubes)); };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) ++around[cube_of(t)];
  std::vector<IntersectionPlace> places;
  for (const std::uint32_t t : mesh.intersecting)
    places.push_back({mesh.box(t), around[cube_of(t)]});
  const std::vector<LatticeBox> boxes = mend_boxes(places, frame);
  MeshGather whole;
  for (const LatticeBox& box : boxes) {
    MeshGather near;
    near.add(mesh, [&](std::size_t t) { return mesh.box(t).meets(box); });
    whole.add(mend_box(near.take(), box, refine, counts));
  }
  whole.add(mesh, [&](std::size_t t) {
    return std::ranges::none_of(boxes,
                                [&](const LatticeBox& box) { return lies_in(mesh, t, box); });
  });
  return whole.take();
}

// All that a run does, one after the other; after(counts) of the mesh as it is then.
template <class F>
void refine_all(RefineMesh& mesh, const RefineFrame& frame, const RefineParameters& refine,
                F&& after) {
  RefineCounts last;
  for (int pass = 0; pass < refine_passes; ++pass) {
    last = {};
    mesh = refine_range(mesh, CubeLattice(frame, pass), {}, refine, last);
    after(last);
  }
  if (refine.intersections != IntersectionRule::none) return;
  RefineCounts counts;
  mesh = mended(mesh, frame, refine, counts);
  after(last.patched_by(counts));
}

}  // namespace voxweld::testing
