// Stand-ins for the paper's models, as exact solids.
#pragma once

#include "tests/paper/scene.h"

namespace voxweld::paper {

struct ModelSpec {
  std::filesystem::path folder;
  std::int64_t cells = 256;
};

// A machined part: plates, a boss, bores, a slot, turned. Meant for 64 cells.
void write_part(const ModelSpec& spec);

// Steps, a cella with a door, columns with bases and capitals, beams and a gable roof, of flat
// faces alone as a polygonal model has, but for round columns. Meant for 256 cells.
struct TempleSpec : ModelSpec {
  std::string name = "temple";
  bool turned = false;         // no face along the grid
  bool round_columns = false;  // else of twelve sides
};
void write_temple(const TempleSpec& spec);

// A closed triangle mesh from elsewhere, filling nine tenths of the grid. Errors as
// read_mesh_file().
struct MeshSpec : ModelSpec {
  std::string name;
  std::filesystem::path mesh;
};
void write_mesh_model(const MeshSpec& spec);

// A cube with a character standing out of each side. Meant for 128 cells. Writes
//   cube.toml            the cube and its characters as one solid
//   characters.toml      the characters alone, each of its parts a solid of its own
//   cube_materials.toml  of three materials: 1 the cube, 2 the characters of four sides, 3 those of
//                        the last two
//   cube.nrrd            the same as labels of voxels
// InputError where the font cannot be read.
struct CubeSpec : ModelSpec {
  std::filesystem::path font;
  std::array<char32_t, 6> characters{};
};
void write_cube(const CubeSpec& spec);

}  // namespace voxweld::paper
