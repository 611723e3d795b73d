// Every artifact kind, cut at every length and with every byte changed: reading all of it must say
// that it is damaged, whatever part is read first, and never return data.
#include <functional>

#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

void read_all_of_shard(const fs::path& path) {
  const ShardArtifact artifact(path);
  artifact.summary();
  artifact.nodes();
  artifact.history();
  BrickOctree brick;
  // The tests' volumes have a few bricks a side.
  for (std::uint64_t code = 0; code < 4096; ++code)
    if (artifact.has_brick(code)) artifact.read_brick(code, brick);
}

void read_all_of_top(const fs::path& path) {
  const TopArtifact artifact(path);
  artifact.counts();
  artifact.tiles();
  artifact.shards();
  artifact.leaves(0, ~std::uint64_t{0} >> 1);
}

void read_all_of_tile(const fs::path& path) {
  TileArtifact(path).read();
}

struct Kind {
  const char* ending;
  void (*read_all)(const fs::path&);
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.ending;
}

// "" when reading says that it is damaged.
std::string fault(const Kind& kind, const fs::path& path) {
  try {
    kind.read_all(path);
  } catch (const DamagedArtifact& damage) {
    return damage.path() == path.string() ? "" : "names " + damage.path();
  } catch (const std::exception& other) {
    return std::string("throws something else: ") + other.what();
  }
  return "is read as data";
}

void expect_all_damage_found(const Kind& kind, const fs::path& original) {
  const Bytes whole = read_whole_file(original);
  kind.read_all(original);  // whole it can be read
  const fs::path path = original.string() + ".damaged";
  const auto check = [&](const Bytes& bytes, const std::string& what) {
    write_whole_file(path, bytes, Durability::rename_only);
    const std::string found = fault(kind, path);
    ASSERT_EQ(found, "") << what << " of " << whole.size();
  };
  for (std::size_t length = 0; length < whole.size(); ++length)
    check(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)),
          "cut to " + std::to_string(length) + " bytes");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Bytes changed = whole;
    changed[i] ^= std::byte(1u << (i % 8));
    check(changed, "bit changed in byte " + std::to_string(i));
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  check(longer, "one byte longer");
  std::swap_ranges(longer.begin(), longer.begin() + 8, longer.begin() + 64);
  check(longer, "pieces swapped");
}

class ArtifactDamage : public ::testing::TestWithParam<Kind> {};

TEST_P(ArtifactDamage, IsFoundInAnyByteAndAtAnyLength) {
  // A cube that meets several bricks, so that there are bricks, nodes, top leaves and a mesh; few
  // cells, so that all of it stays small.
  const Scene scene(volume_of({17, 6, 5}, [](Index3 at) { return at.x > 2 ? 200 : 10; }));
  VOXWELD_EXPECT_DONE(scene.run({"work.brick=16", "work.shard=2", "simplify.tolerance=0.2"}));
  const auto files = files_ending(scene.work(), GetParam().ending);
  ASSERT_FALSE(files.empty());
  EXPECT_LT(fs::file_size(files[0]), 60000u) << "too many cases for a test";
  expect_all_damage_found(GetParam(), files[0]);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ArtifactDamage,
                         ::testing::Values(Kind{".octree", read_all_of_shard},
                                           Kind{".tree", read_all_of_top},
                                           Kind{".tile", read_all_of_tile}),
                         [](const auto& each) { return each.param.ending + 1; });

}  // namespace
}  // namespace voxweld::testing
