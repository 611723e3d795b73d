#include <cmath>

#include "storage/support/file_io.h"
#include "tests/paper/glyph_outline.h"
#include "tests/paper/models.h"
#include "tests/support/lattice_place.h"

namespace voxweld::paper {
namespace {

using enum EditOp;

constexpr double half = 46, em = 88;        // of the cube's side, of a character
constexpr double sunk = 3.1, raised = 5.2;  // characters begin in the cube and stand out of it

// The side's outward axis is the third; the second is up, or y on the upper and lower side.
Frame3 side_frame(int side) {
  const double sign = side % 2 == 0 ? 1 : -1;
  Vec3 out, up{0, 0, 1};
  out[side / 2] = sign;
  if (side / 2 == 2) up = {0, 1, 0};
  return {{}, {cross(up, out), up, out}};
}

// The cube's own is 1.
std::uint8_t material_of_side(int side) {
  return side < 4 ? 2 : 3;
}

struct Side {
  Frame3 frame;
  Outline outline;
};

bool in_character(const Side& side, Vec3 p) {
  const auto& axes = side.frame.axes;
  const double out = dot(p, axes[2]);
  return out >= half - sunk && out <= half + raised &&
         holds(side.outline, Point2{dot(p, axes[0]), dot(p, axes[1])});
}

std::uint8_t label_at(const std::vector<Side>& sides, Vec3 p) {
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (in_character(sides[i], p)) return material_of_side(static_cast<int>(i));
  const bool in_cube = std::abs(p.x) <= half && std::abs(p.y) <= half && std::abs(p.z) <= half;
  return in_cube ? 1 : 0;
}

void write_labels(const Scene& scene, const std::vector<Side>& sides) {
  const std::int64_t n = scene.samples();
  std::string text = "NRRD0004\n# labels: 1 cube, 2 and 3 characters\ntype: uint8\ndimension: 3\n";
  text += "sizes: " + std::to_string(n) + " " + std::to_string(n) + " " + std::to_string(n) + "\n";
  text += "spacings: 1 1 1\nencoding: raw\n\n";
  each_index(splat(n), [&](Index3 s) {
    text += static_cast<char>(label_at(sides, scene.unplace(testing::as_vec3(s))));
  });
  write_whole_file(scene.folder() / "cube.nrrd", as_bytes(text), Durability::rename_only);
}

}  // namespace

void write_cube(const CubeSpec& spec) {
  Scene cube(spec.folder, {spec.cells, 128, {}}), characters = cube, materials = cube;
  cube.box(add, {}, {half, half, half});
  materials.of_material(1);
  materials.box(add, {}, {half, half, half});
  std::vector<Side> sides;
  for (int i = 0; i < 6; ++i) {
    const auto character = spec.characters[static_cast<std::size_t>(i)];
    sides.push_back({side_frame(i), glyph_outline(spec.font, character, em)});
    const std::string name = "character" + std::to_string(i + 1) + ".off";
    write_off(spec.folder / name,
              extrude(sides.back().outline, half - sunk, half + raised, sides.back().frame));
    cube.mesh(add, name, {});
    characters.mesh(add, name, {});
    materials.of_material(material_of_side(i));
    materials.mesh(add, name, {});
  }
  cube.write("cube", "A cube with a character standing out of each side, of exact solids");
  characters.write("characters", "The characters of the cube alone, of exact solids");
  materials.write("cube_materials", "The cube and its characters, of three materials");
  write_labels(cube, sides);
}

}  // namespace voxweld::paper
