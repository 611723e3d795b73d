#include "tests/measure/loaded_mesh.h"

#include <gtest/gtest.h>

#include <fstream>

#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

LoadedMesh loaded_from(const std::string& name, const std::string& text) {
  const testing::TempDirectory directory;
  std::ofstream(directory.path() / name) << text;
  return load_to_measure(directory.path() / name);
}

TEST(LoadedMesh, KeepsWhatIsDegenerate) {
  const LoadedMesh loaded =
      loaded_from("a.obj", "v 1 2 3\nv 2 2 3\nv 1 3 3\nv 1 2 3\nf 1 2 3\nf 1 1 2\nf 4 2 3\n");
  EXPECT_EQ(loaded.mesh.vertices.size(), 4u) << "not welded";
  EXPECT_EQ(loaded.mesh.triangles.size(), 3u);
  EXPECT_TRUE(loaded.rounded);
}

TEST(LoadedMesh, TakesStlApart) {
  const LoadedMesh loaded =
      loaded_from("a.stl",
                  "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                  "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  EXPECT_EQ(loaded.mesh.vertices.size(), 3u);
  EXPECT_EQ(loaded.mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
}

TEST(LoadedMesh, RoundsToThe1024thOfASample) {
  const LoadedMesh loaded =
      loaded_from("a.obj", "v -0.5 2 3.00048\nv 2 2.00051 3\nv 1 3 3\nf 1 2 3\n");
  EXPECT_EQ(on_lattice(loaded, loaded.mesh.vertices),
            (std::vector<LatticePoint>{{512, 0, 0}, {3072, 1, 0}, {2048, 1024, 0}}));
}

TEST(LoadedMesh, Refusals) {
  const LoadedMesh large = loaded_from("a.obj", "v 0 0 0\nv 4096 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(on_lattice(large, large.mesh.vertices), InputError);
  EXPECT_THROW(loaded_from("a.obj", "v 0 0 0\n"), FormatError);
  EXPECT_THROW(load_to_measure("missing.ply"), InputError);
}

}  // namespace
}  // namespace voxweld
