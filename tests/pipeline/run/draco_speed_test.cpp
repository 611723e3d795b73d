// Which of Draco's speeds meshes are encoded with.
#include <gtest/gtest.h>

#include <set>

#include "stages/encode/draco_codec.h"
#include "storage/artifact/tile_artifact.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

std::set<std::string> drc_files(const Scene& scene) {
  std::set<std::string> files;
  for (const auto& file : files_ending(scene.output(), ".drc")) files.insert(text_of_file(file));
  return files;
}
std::set<std::string> encoded(const Scene& scene, int speed) {
  EncodeParameters parameters;
  parameters.encode_speed = parameters.decode_speed = speed;
  std::set<std::string> files;
  for (const auto& file : files_ending(scene.work(), ".tile")) {
    const TileArtifact tile(file);
    const EncodedMesh mesh = encode_draco(tile.read(), parameters);
    files.emplace(reinterpret_cast<const char*>(mesh.bytes.data()), mesh.bytes.size());
  }
  return files;
}

TEST(DracoSpeed, IsThatOfRoughNormalsForLabelsWhoseEdgesAreNotCollapsed) {
  const Settings shared = {"labels.mode=shared", "output.merged=false", "output.formats=[\"drc\"]"};
  for (const char* refine : {"off", "repair", "collapse"}) {
    SCOPED_TRACE(refine);
    const Scene scene(cell_labels({40, 38, 36}, 6, 0, 1));
    VOXWELD_EXPECT_DONE(scene.run(shared + Settings{std::string("simplify.refine=") + refine}));
    const int speed = std::string(refine) == "collapse" ? 3 : 4;
    ASSERT_FALSE(drc_files(scene).empty());
    EXPECT_EQ(drc_files(scene), encoded(scene, speed));
    EXPECT_NE(drc_files(scene), encoded(scene, 7 - speed));
  }
}

TEST(DracoSpeed, IsThatOfPredictedNormalsForIsosurfaces) {
  const Scene scene(noise_volume(splat(20), 1));
  VOXWELD_EXPECT_DONE(
      scene.run({"simplify.refine=off", "output.merged=false", "output.formats=[\"drc\"]"}));
  ASSERT_FALSE(drc_files(scene).empty());
  EXPECT_EQ(drc_files(scene), encoded(scene, 3));
}

}  // namespace
}  // namespace voxweld::testing
