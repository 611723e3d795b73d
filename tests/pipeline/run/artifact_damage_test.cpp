// Every artifact kind, cut at every length and with every byte changed: reading all of it must say
// that it is damaged, whatever part is read first, and never return data.
#include <fstream>
#include <functional>

#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/label_counts.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/tile_plan_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

constexpr int brick_level = 4, shard_level = 5;  // of the tests' runs

void read_all_of_shard(const fs::path& path) {
  const ShardArtifact artifact(path);
  artifact.summary();
  BrickOctree brick;
  GhostLayer ghost;
  artifact.each_piece([&](const PieceRecord& piece) {
    artifact.read_piece(piece, brick_level, brick);
    artifact.read_ghost_layer(piece, ghost);
  });
  for (std::uint64_t page = 0; page < artifact.node_pages(); ++page)
    artifact.each_node(page, [&](const MaterialNode& node, std::span<const std::byte>) {
      artifact.clusters(node.material, node.node.key);
    });
  // As builds do that keep all bricks, or cut them.
  const ArtifactReader file(path, shard_kind, shard_version);
  ShardArtifactWriter copy(path.string() + ".copy", {}, {});
  for (const BuiltBrick& built : read_history(file).bricks) {
    copy.brick(built.code, file, [](const PieceBytes&) {});
    each_piece_in(file, built.code,
                  [&](const PieceHead& head) { read_octree(file, head, brick_level, brick); });
  }
}

void read_all_of_tables(const MaterialTop& top) {
  top.batches();
  top.tiles(0, top.tile_count());
  constexpr std::uint64_t end = ~std::uint64_t{0} >> 1;
  for (std::uint64_t i = 0; i < top.surface_count(); ++i) {
    const SurfaceRecord surface = top.surfaces(i, 1).front();
    top.nodes(surface, shard_level, 0, end);
    top.leaves(surface, 0, end);
    top.clusters(i);
  }
}

void read_all_of_top(const fs::path& path) {
  const TopArtifact artifact(path);
  artifact.counts();
  artifact.shards();
  read_all_of_tables(MaterialTop(artifact));
}

void read_all_of_tile(const fs::path& path) {
  const TileArtifact artifact(path);
  for (std::size_t i = 0; i < artifact.meshes(); ++i) artifact.read(i);
}

void read_all_of_cubes(const fs::path& path) {
  const CubeMeshArtifact artifact(path);
  artifact.counted<RefineCounts>();
  artifact.blocks();
  artifact.changes();
  for (std::size_t i = 0; i < artifact.pieces().size(); ++i) {
    for (const CubePart part : {CubePart::inside, CubePart::leaving}) artifact.read(i, part);
    artifact.holes(i);
  }
}

void read_all_of_tile_plan(const fs::path& path) {
  const TilePlanArtifact artifact(path);
  artifact.sources();
  const MaterialTop tables(artifact.file());
  read_all_of_tables(tables);
  artifact.middles(0, tables.surface_count());
}

void read_all_of_counts(const fs::path& path) {
  LabelCounts(path).each([](const LabelCount&) { return true; });
}

struct Kind {
  const char* name;
  const char* mode;  // of labels
  const char* ending;
  void (*read_all)(const fs::path&);
  const char* refine = "off";
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
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
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
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
  const bool labels = std::string(GetParam().mode) != "off";
  const Scene scene(volume_of(labels ? Index3{17, 3, 3} : Index3{17, 6, 5},
                              [](Index3 at) { return at.x > 2 ? 200 : 10; }));
  VOXWELD_EXPECT_DONE(scene.run({"work.brick=16", "work.shard=2", "simplify.tolerance=0.2",
                                 std::string("labels.mode=") + GetParam().mode,
                                 std::string("simplify.refine=") + GetParam().refine}));
  const auto files = files_ending(scene.work(), GetParam().ending);
  ASSERT_FALSE(files.empty());
  EXPECT_LT(fs::file_size(files[0]), 60000u) << "too many cases for a test";
  expect_all_damage_found(GetParam(), files[0]);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ArtifactDamage,
    ::testing::Values(Kind{"octree", "off", ".octree", read_all_of_shard},
                      Kind{"tree", "off", ".tree", read_all_of_top},
                      Kind{"tile", "off", ".tile", read_all_of_tile},
                      Kind{"cubes", "off", ".cubes", read_all_of_cubes, "collapse"},
                      Kind{"tile_plan", "off", "tile.plan", read_all_of_tile_plan, "collapse"},
                      Kind{"octrees_of_each_label", "each", ".octree", read_all_of_shard},
                      Kind{"tree_of_each_label", "each", ".tree", read_all_of_top},
                      Kind{"tiles_of_each_label", "each", ".tile", read_all_of_tile},
                      Kind{"cubes_of_each_label", "each", ".cubes", read_all_of_cubes, "collapse"},
                      Kind{"tile_plan_of_each_label", "each", "tile.plan", read_all_of_tile_plan,
                           "collapse"},
                      Kind{"octree_of_shared_labels", "shared", ".octree", read_all_of_shard},
                      Kind{"tile_of_shared_labels", "shared", ".tile", read_all_of_tile},
                      Kind{"counts_of_a_shard", "each", ".labels", read_all_of_counts},
                      Kind{"counts_of_all", "each", "labels.all", read_all_of_counts}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace voxweld::testing
