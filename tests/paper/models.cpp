#include "tests/paper/models.h"

#include <algorithm>
#include <limits>

#include "storage/meshes/mesh_file.h"

namespace voxweld::paper {
namespace {

using enum EditOp;

// Through the faces of a cylinder or box that a cut begins at.
constexpr double through = 300;

}  // namespace

// As `voxweld phantom part`, whose lengths are 512ths, less its fins: thinner than a cell here.
void write_part(const ModelSpec& spec) {
  Scene scene(spec.folder, {spec.cells, 512, {13.2, -35, 21.2}});
  const Vec3 x{1, 0, 0}, z{0, 0, 1};
  scene.box(add, {0, 0, -60}, {150, 110, 24});
  scene.box(add, {95, 0, 20}, {18, 90, 70});
  scene.box(add, {-95, 0, 20}, {18, 90, 70});
  scene.cylinder(add, {0, 0, 10}, z, 62, 150);
  scene.cylinder(subtract, {}, z, 38, 2 * through);
  for (const double at_x : {-125.0, 125.0})
    for (const double at_y : {-85.0, 85.0}) scene.cylinder(subtract, {at_x, at_y, -60}, z, 13, 120);
  for (const double at_y : {40.0, -40.0})
    scene.cylinder(subtract, {0, at_y, 40}, x, 22, 2 * through);
  scene.box(subtract, {0, 0, 80}, {12, 200, 18});
  scene.write("part", "A machined part, of exact solids");
}

namespace {

constexpr double column_radius = 7, column_height = 82, column_foot = -58;

void write_temple_meshes(const std::filesystem::path& folder) {
  write_off(folder / "column.off",
            extrude({regular_polygon(12, column_radius)}, 0, column_height, {}));
  // Along x: the outline lies in (y, z).
  const Frame3 along_x{{}, {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}};
  write_off(folder / "roof.off", extrude({{{-62, 0}, {62, 0}, {0, 36}}}, -92, 92, along_x));
  write_off(folder / "tympanum.off", extrude({{{-50, 3}, {50, 3}, {0, 31}}}, 0, 8, along_x));
}

void add_column(Scene& scene, const TempleSpec& spec, double x, double y) {
  scene.box(add, {x, y, -57}, {8.5, 8.5, 2});
  if (spec.round_columns)
    scene.cylinder(add, {x, y, column_foot + column_height / 2}, {0, 0, 1}, column_radius,
                   column_height);
  else
    scene.mesh(add, "column.off", {x, y, column_foot});
  scene.box(add, {x, y, 23}, {9, 9, 2.2});
}

}  // namespace

void write_temple(const TempleSpec& spec) {
  write_temple_meshes(spec.folder);
  Scene scene(spec.folder, {spec.cells, 256, spec.turned ? Vec3{4.3, -6.1, 21.7} : Vec3{}});
  for (int step = 0; step < 4; ++step) {
    const double in = 5.0 * step;
    scene.box(add, {0, 0, -77 + 5.0 * step}, {108 - in, 76 - in, 3.5});
  }
  scene.box(add, {0, 0, -16}, {56, 32, 45});
  scene.box(subtract, {0, 0, -16}, {51, 27, 40});
  scene.box(subtract, {54, 0, -30}, {12, 11, 28});
  scene.box(subtract, {-54, 0, -30}, {12, 11, 28});
  for (int i = -4; i <= 4; ++i)
    for (const double y : {-50.0, 50.0}) add_column(scene, spec, 20.0 * i, y);
  for (const double y : {-25.0, 0.0, 25.0})
    for (const double x : {-80.0, 80.0}) add_column(scene, spec, x, y);
  scene.box(add, {0, 0, 29}, {89, 59, 4.6});
  scene.box(add, {0, 0, 36}, {92, 62, 3});
  scene.mesh(add, "roof.off", {0, 0, 38.5});
  scene.mesh(subtract, "tympanum.off", {86, 0, 38.5});
  scene.mesh(subtract, "tympanum.off", {-94, 0, 38.5});
  scene.write(spec.name, "A temple of flat faces, of exact solids");
}

void write_mesh_model(const MeshSpec& spec) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3 lo{inf, inf, inf}, hi{-inf, -inf, -inf};
  for (const Vec3& v : read_mesh_file(spec.mesh).mesh.vertices)
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], v[a]);
      hi[a] = std::max(hi[a], v[a]);
    }
  const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  Scene scene(spec.folder, {spec.cells, extent / 0.9, {}});
  scene.mesh(add, std::filesystem::absolute(spec.mesh), (lo + hi) * -0.5);
  scene.write(spec.name, spec.mesh.filename().string());
}

}  // namespace voxweld::paper
