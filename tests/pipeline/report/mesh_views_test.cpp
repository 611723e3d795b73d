// Pictures of a mesh of several tiles: the same however much of it is in memory at once.
#include "pipeline/report/mesh_views.h"

#include "pipeline/output/load.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

TEST(MeshViews, AreTheSameWhateverIsKeptAndDecodedAtOnce) {
  const Workplace place;
  place.run_scene({"surface.isovalue=127.5", "simplify.tolerance=0.2", "output.tile_vertices=1024",
                   "output.report=false"});
  ViewOptions options;
  options.triangles = 4096;
  options.threads = false;
  options.memory = 0;  // nothing is kept
  const std::filesystem::path directory = place.at("scene.mesh");
  std::size_t tiles = 0;
  each_mesh_file(directory, [&](const auto&, const auto&) { ++tiles; });
  EXPECT_GT(tiles, 5u);
  const MeshViews plain = draw_views(directory, options);
  EXPECT_TRUE(std::ranges::any_of(plain.pictures[0].rgb,
                                  [&](auto sample) { return sample != plain.pictures[0].rgb[0]; }));
  const auto expect_same = [&] {
    const MeshViews views = draw_views(directory, options);
    EXPECT_EQ(views.bounds.lo, plain.bounds.lo);
    EXPECT_EQ(views.bounds.hi, plain.bounds.hi);
    for (std::size_t i = 0; i < views.pictures.size(); ++i)
      EXPECT_EQ(views.pictures[i].rgb, plain.pictures[i].rgb) << i;
  };
  for (const bool threads : {false, true})
    for (const std::uint64_t memory : {0, 512, 4096}) {
      SCOPED_TRACE(std::to_string(memory) + (threads ? " MiB, threads" : " MiB"));
      options.threads = threads;
      options.memory = memory << 20;
      expect_same();
    }
  options.triangles = std::uint64_t{1} << 40;  // decoded twice, four at once
  expect_same();
}

}  // namespace
}  // namespace voxweld::testing
