// How smooth, and how true, surfaces of label volumes are: voxweld's against surface nets with
// constrained relaxation, on solids that were made voxels.
// usage: paper_labels
// Prints a Markdown table; lengths in voxels. Exit code 1 where another surface than voxweld's is
// nearest to the true one.
#include <fmt/format.h>

#include <algorithm>

#include "stages/solids/solid.h"
#include "tests/paper/surface_net.h"
#include "tests/paper/true_surface.h"
#include "tests/support/contour_in_memory.h"
#include "tests/support/lattice_place.h"

namespace {

using namespace voxweld;
using namespace voxweld::paper;

constexpr std::int64_t side = 64;

bool inside(const Solid& solid, Index3 s) {
  return solid_holds(solid, testing::as_vec3(s));
}

TriangleMesh label_surface(const Solid& solid, bool simplify) {
  const auto labels = testing::MemoryVolume::made<std::uint8_t>(
      splat(side), SampleType::u8, [&](Index3 s) { return inside(solid, s) ? 1 : 0; });
  ContourParameters parameters;
  parameters.surface.label = 1;
  parameters.surface.isovalue = 1;
  parameters.simplify.enabled = simplify;
  const VolumeContour contour = contour_volume(labels, parameters, {});
  const testing::LatticeWeld weld = testing::weld_tiles(contour.tiles);
  TriangleMesh mesh{{}, weld.triangles};
  for (const auto& q : weld.vertices)
    mesh.vertices.push_back(testing::place_of(contour.tiles[0].lattice, q));
  return mesh;
}

// Returns the mean distance.
double print(const char* solid_name, const Solid& solid, const std::string& method,
             const TriangleMesh& mesh) {
  const SurfaceErrors e = surface_errors(solid, mesh);
  fmt::print(
      "| {} | {} | {} | {:.3f} | {:.3f} | {:.2f} | {:.1f} | {:.0f} | {:.0f} | {:+.2f} "
      "|\n",
      solid_name, method, e.triangles, e.mean, e.rms, e.max, e.mean_degrees, e.worst_degrees,
      e.max_degrees, 100 * e.volume);
  return e.mean;
}

// Whether voxweld's surface, before it is simplified, is nearest to the solid's in the mean.
bool compare(const char* name, const Solid& solid) {
  const SurfaceNet net(splat(side), [&](Index3 s) { return inside(solid, s); });
  double nearest = print(name, solid, "voxel faces (midpoints, axis normals)", net.mesh());
  const auto other = [&](const std::string& method, const SurfaceNet& moved) {
    nearest = std::min(nearest, print(name, solid, method, moved.mesh()));
  };
  SurfaceNet means = net;
  means.to_means_of_midpoints();
  other("net at the means of midpoints", means);
  for (const SurfaceNet::Relaxation& relaxation :
       {SurfaceNet::Relaxation{16, 0.5, 0.5}, {100, 0.5, 0.5}, {16, 0.5, 1}}) {
    SurfaceNet relaxed = net;
    relaxed.relax(relaxation);
    other(fmt::format("surface net, {} iterations, within {} of the cell's centre",
                      relaxation.iterations, relaxation.reach),
          relaxed);
  }
  const double own =
      print(name, solid, "voxweld `surface.label`, not simplified", label_surface(solid, false));
  print(name, solid, "voxweld `surface.label`, tolerance 0.1", label_surface(solid, true));
  return own < nearest;
}

Solid tilted(SolidShape shape) {
  Solid solid;
  solid.shape = shape;
  solid.center = {31.4, 30.7, 31.1};
  const double a = 0.8, b = 0.6;
  solid.axes = {Vec3{a, b, 0}, Vec3{-b * a, a * a, b}, Vec3{b * b, -a * b, a}};
  return solid;
}

}  // namespace

int main() {
  Solid sphere = tilted(SolidShape::sphere), torus = tilted(SolidShape::torus),
        box = tilted(SolidShape::box), slab = tilted(SolidShape::box);
  sphere.radius = 20;
  torus.radius = 15;
  torus.tube = 5;
  box.size = {34, 26, 20};
  slab.size = {36, 30, 3};
  fmt::print(
      "| solid | surface | triangles | distance: mean | rms | max | normals off by degrees: mean | "
      "99 % | max | volume off, % |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  bool nearest = compare("sphere, radius 20", sphere);
  nearest = compare("torus, 15 and 5", torus) && nearest;
  nearest = compare("tilted box, 34 x 26 x 20", box) && nearest;
  nearest = compare("tilted slab, 3 thick", slab) && nearest;
  // Of those as thin as a sample no surface knows much.
  slab.size.z = 1.2;
  sphere.radius = 2.2;
  torus.tube = 1.5;
  compare("tilted slab, 1.2 thick", slab);
  compare("sphere, radius 2.2", sphere);
  compare("torus, 15 and 1.5", torus);
  return nearest ? 0 : 1;
}
