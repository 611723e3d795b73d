// labels.map that merges labels, end to end: what comes out is what a volume gives in which they
// were one label from the start.
#include <fstream>

#include "storage/manifest/manifest.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

// 1, 2 and 7 are one, 3 and 4 become one of another number, 5 is left out, 6 stays.
const char* const map_text = "label,material\n1,1\n2,1\n3,900\n4,900\n5,\n7,1\n20-30,900\n";
std::uint64_t merged(std::uint64_t label) {
  if (label == 1 || label == 2 || label == 7) return 1;
  if (label == 3 || label == 4) return 900;
  return label == 5 ? 0 : label;
}

RawVolume relabelled(RawVolume volume) {
  for (std::size_t i = 0; i < volume.samples.size(); i += 2) {
    const std::uint64_t label = merged(std::to_integer<std::uint64_t>(volume.samples[i]) |
                                       std::to_integer<std::uint64_t>(volume.samples[i + 1]) << 8);
    volume.samples[i] = static_cast<std::byte>(label & 255);
    volume.samples[i + 1] = static_cast<std::byte>(label >> 8);
  }
  return volume;
}

class MergedLabels : public ::testing::TestWithParam<const char*> {};

TEST_P(MergedLabels, AreAsIfTheyHadBeenOneFromTheStart) {
  const RawVolume volume = cell_labels({48, 45, 40}, 7, 0.01, 31);
  const Scene scene(volume);
  const auto map = scene.directory() / "map.csv";
  std::ofstream(map) << map_text;
  const Settings settings = {std::string("labels.mode=") + GetParam(), "work.brick=16",
                             "work.shard=2", "output.tile_vertices=2048"};
  const Settings mapped = settings + Settings{"labels.map=" + map.string()};
  const Tree by_map = scene.clean_tree(mapped);
  VOXWELD_EXPECT_DONE(scene.run(mapped));
  expect_good(scene.output());
  scene.write_volume(relabelled(volume));
  EXPECT_EQ(difference(scene.clean_tree(settings), by_map), "");

  LabelListReader labels(scene.output() / labels_name);
  std::vector<std::uint64_t> found;
  while (const auto label = labels.next()) found.push_back(label->label);
  EXPECT_EQ(found, (std::vector<std::uint64_t>{1, 6, 900}));
}

INSTANTIATE_TEST_SUITE_P(Modes, MergedLabels, ::testing::Values("each", "shared"),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace voxweld::testing
