#include <map>
#include <set>

#include "storage/readers/open_volume.h"
#include "storage/spool/spool.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Small bricks and tiles, so that a run leaves several of everything.
const std::vector<std::string> many_of_all = {"work.brick=16",          "work.shard=1",
                                              "work.chunk=8",           "output.tile_vertices=1024",
                                              "simplify.enabled=false", "work.copy=true"};

std::map<std::string, int> kinds_below(const Workplace& place, const std::string& folder) {
  std::map<std::string, int> kinds;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const nlohmann::json document = place.info(entry.path().string(), {"--check", "--verbose"});
    const std::string kind = document.value("kind", "");
    EXPECT_NE(kind, "") << entry.path();
    EXPECT_FALSE(place.run({"info", entry.path().string(), "--verbose"}).out.empty());
    ++kinds[kind];
  }
  return kinds;
}

TEST(Info, RecognisesEveryFileThatARunLeaves) {
  const Workplace place;
  place.run_scene(many_of_all);
  const auto work = kinds_below(place, place.at("scene.work"));
  for (const char* kind : {"octree", "tile", "asset_record", "shard_record", "zarr_chunk"})
    EXPECT_GT(work.contains(kind) ? work.at(kind) : 0, 1) << kind;
  for (const char* kind : {"top_tree", "brick_store", "config"})
    EXPECT_EQ(work.contains(kind) ? work.at(kind) : 0, 1) << kind;
  const auto output = kinds_below(place, place.at("scene.mesh"));
  EXPECT_GT(output.at("mesh"), 3);
  EXPECT_EQ(output.at("output"), 1);
  EXPECT_EQ(output.at("tile_list"), 1);
  EXPECT_EQ(output.at("report"), 1);
  EXPECT_EQ(output.size(), 4u);
}

TEST(Info, OfAnOutputWithoutTilesFitsWhatVerifyFinds) {
  const Workplace place;
  place.run_scene({"output.tiles=false"});
  const std::string mesh = place.at("scene.mesh");
  const auto found = nlohmann::json::parse(place.run({"verify", mesh, "--json"}).out);
  const nlohmann::json counts = place.info(mesh).at("counts");
  EXPECT_EQ(counts.at("tiles"), 0);
  EXPECT_EQ(found.at("vertices"), counts.at("vertices"));
  EXPECT_EQ(found.at("triangles"), counts.at("triangles"));
}

TEST(Info, KeepsTheHistogramOfAVolumeReadInPlace) {
  const Workplace place;
  place.run_scene({"surface.isovalue=otsu"});
  const auto work = kinds_below(place, place.at("scene.work"));
  EXPECT_EQ(work.at("histogram"), 1);
  const std::string path = first_file(place.at("scene.work"), "/histogram");
  const nlohmann::json values = place.info(path).at("values");
  EXPECT_EQ(values.at("samples"), 24 * 24 * 24);
  const nlohmann::json volume = place.info(place.at("scene.nrrd")).at("values");
  EXPECT_EQ(values.at("suggested_isovalue"), volume.at("suggested_isovalue"));
  EXPECT_EQ(values.at("quantiles"), volume.at("quantiles"));
}

TEST(Info, TellsTheToleranceOfABuild) {
  const Workplace place;
  place.run_scene({"simplify.tolerance=0.25"});
  EXPECT_EQ(kinds_below(place, place.at("scene.work")).at("tolerance_note"), 1);
  const std::string note = first_file(place.at("scene.work"), "/tolerance");
  EXPECT_EQ(place.info(note).at("tolerance"), 0.25);
  write_bytes(note, "much");
  expect_refused({"info", note}, {note, "has no number", "remove the file"});
}

TEST(Info, CountsAgreeFromStageToStage) {
  const Workplace place;
  place.run_scene(many_of_all);
  const nlohmann::json output = place.info(place.at("scene.mesh"), {"--check", "--verbose"});
  const nlohmann::json top = place.info(first_file(place.at("scene.work"), "top.tree"));
  EXPECT_EQ(top.at("vertices"), output.at("counts").at("vertices"));
  EXPECT_EQ(top.at("leaves"), output.at("counts").at("leaves"));
  EXPECT_EQ(top.at("errors"), output.at("error").at("levels"));
  const nlohmann::json merged = place.info(place.at("scene.mesh/mesh.drc"));
  EXPECT_EQ(merged.at("vertices"), output.at("counts").at("vertices"));
  EXPECT_EQ(merged.at("triangles"), output.at("counts").at("triangles"));
  const std::size_t meshes = output.at("files").at("count");
  EXPECT_EQ(output.at("file_list").size(), meshes + 1);  // and the list of tiles
  EXPECT_EQ(output.at("check").at("files"), meshes + 1);
  const nlohmann::json tiles = place.info(place.at("scene.mesh/tiles.jsonl"), {"--verbose"});
  EXPECT_EQ(tiles.at("triangles"), output.at("counts").at("triangles"));
  EXPECT_EQ(tiles.at("tiles"), tiles.at("tile_list").size());
}

TEST(Info, SurveysWorkDirectories) {
  const Workplace place;
  place.run_scene(many_of_all);
  const nlohmann::json work = place.info(place.at("scene.work"), {"--check"});
  EXPECT_EQ(work.at("kind"), "work_directory");
  std::vector<std::string> stages;
  for (const auto& stage : work.at("stages")) {
    stages.push_back(stage.at("stage"));
    const std::string folder = place.at("scene.work/" + stage.at("folder").get<std::string>());
    const nlohmann::json own = place.info(folder, {"--check"});
    EXPECT_EQ(own.at("kind"), "stage_directory");
    EXPECT_EQ(own.at("bytes"), stage.at("bytes"));
  }
  EXPECT_EQ(stages, (std::vector<std::string>{"ingest", "build", "merge", "stitch", "encode"}));
  EXPECT_TRUE(work.at("check").at("damaged").empty());
}

TEST(Info, DescribesVolumesAndStores) {
  const Workplace place;
  const nlohmann::json volume = place.info(place.phantom("scene.nrrd"));
  EXPECT_EQ(volume.at("kind"), "volume");
  EXPECT_EQ(volume.at("format"), "nrrd");
  EXPECT_EQ(volume.at("size"), nlohmann::json({24, 24, 24}));
  EXPECT_EQ(volume.at("access"), "box");
  EXPECT_EQ(volume.at("values").at("samples"), 24 * 24 * 24);
  const nlohmann::json store = place.info(place.phantom("scene.zarr"), {"--check", "--verbose"});
  EXPECT_EQ(store.at("kind"), "brick_store");
  EXPECT_EQ(store.at("values"), volume.at("values"));
  EXPECT_EQ(store.at("shards").at("total"), store.at("shard_list").size());
  // Without its records it is a Zarr array like any other.
  fs::remove_all(place.at("scene.zarr/.voxweld"));
  const nlohmann::json zarr = place.info(place.at("scene.zarr"));
  EXPECT_EQ(zarr.at("kind"), "volume");
  EXPECT_EQ(zarr.at("values"), volume.at("values"));
  EXPECT_EQ(zarr.at("zarr").at("chunk"), nlohmann::json({32, 32, 32}));
}

TEST(Info, CountsLabelsWhenAsked) {
  const Workplace place;
  // Slices of 2 x 2: four of the highest label there may be, two of another, two of 0.
  std::string samples;
  for (int i = 0; i < 4; ++i)
    for (int z = 0; z < 8; ++z)
      samples += std::string(i < 2 ? 7 : 8, i < 2    ? '\xff'
                                            : i == 2 ? '\7'
                                                     : '\0') +
                 (i < 2 ? "\x7f" : "");
  write_bytes(place.at("labels.raw"), samples);
  const std::vector<std::string> layout = {"--size", "2", "2", "8", "--type", "int64"};
  const auto labels = [&](const std::string& path, std::vector<std::string> more) {
    more.push_back("--labels");
    return place.info(path, more).at("labels");
  };
  const nlohmann::json facts = labels(place.at("labels.raw"), layout);
  const std::uint64_t highest = 9223372036854775807;
  EXPECT_EQ(facts.at("distinct"), 3);
  EXPECT_EQ(facts.at("range"), nlohmann::json({0, highest}));
  EXPECT_EQ(facts.at("background_share"), 0.25);
  EXPECT_EQ(facts.at("largest")[0].at("label"), highest);
  EXPECT_EQ(facts.at("largest")[0].at("samples"), 16);
  EXPECT_EQ(facts.at("largest")[1].at("label"), 0) << "of equals the lower comes first";
  EXPECT_EQ(facts.at("largest")[2].at("from"), nlohmann::json({0, 0, 4}));
  EXPECT_EQ(facts.at("largest")[2].at("to"), nlohmann::json({2, 2, 6}));
  EXPECT_FALSE(place.info(place.at("labels.raw"), layout).contains("labels"));
  // The same in a store, and in what ingest leaves.
  std::vector<std::string> init = {"init", place.at("labels.raw"), "-o", place.at("scene.toml"),
                                   "--labels"};
  init.insert(init.end(), layout.begin(), layout.end());
  EXPECT_THAT(place.run(init).out, HasSubstr("labels.mode = \"each\", of 3 labels; 25 % are"));
  place.run({"ingest", place.at("scene.toml"), "--set", "work.copy=true"});
  EXPECT_EQ(
      labels(
          place.info(place.at("scene.work")).at("path").get<std::string>() + "/" +
              place.info(place.at("scene.work")).at("stages")[0].at("folder").get<std::string>() +
              "/volume.zarr",
          {}),
      facts);
  for (const char* name : {"/labels.all", ".labels"}) {
    const nlohmann::json counts = place.info(first_file(place.at("scene.work"), name), {"--check"});
    EXPECT_EQ(counts.at("kind"), "label_counts");
    EXPECT_EQ(counts.at("labels"), facts);
  }
  expect_refused({"info", place.phantom("scene.nrrd"), "--labels", "--size", "24", "24", "6",
                  "--type", "float32"},
                 {"--labels: labels are integers as they are stored", "has samples of float32"});
}

TEST(Info, TakesTheLayoutOfRawFiles) {
  const Workplace place;
  write_bytes(place.at("scan.bin"), std::string("\0\1\2\3\4\5\6\7", 8));
  const nlohmann::json info = place.info(
      place.at("scan.bin"),
      {"--size", "2", "2", "2", "--type", "uint8", "--spacing", "0.25", "--unit", "mm", "--check"});
  EXPECT_EQ(info.at("format"), "raw");
  EXPECT_EQ(info.at("unit"), "mm");
  EXPECT_EQ(info.at("spacing"), nlohmann::json({0.25, 0.25, 0.25}));
  EXPECT_EQ(info.at("values").at("range"), nlohmann::json({0, 7}));
}

TEST(Info, DescribesSpools) {
  const Workplace place;
  const auto source = open_volume({.path = place.phantom("scene.nrrd")});
  const fs::path spool = place.at("spool.raw");
  spool_volume(*source, spool, Hash128{1, 2}, {});
  for (const char* name : {"spool.raw", "spool.raw.record"}) {
    const nlohmann::json info = place.info(place.at(name), {"--check"});
    EXPECT_EQ(info.at("kind"), "spool_record");
    EXPECT_EQ(info.at("size"), nlohmann::json({24, 24, 24}));
  }
}

TEST(Info, NamesTheFileATemporaryStandsFor) {
  const Workplace place;
  write_bytes(place.at("0-0-0.octree.tmp-host-1-0000000000000000"), "unfinished");
  const nlohmann::json info = place.info(place.at("0-0-0.octree.tmp-host-1-0000000000000000"));
  EXPECT_EQ(info.at("kind"), "temporary");
  EXPECT_EQ(info.at("of"), "0-0-0.octree");
}

TEST(Info, TextHasWhatJsonHas) {
  const Workplace place;
  const std::string text = place.run({"info", place.phantom("scene.nrrd")}).out;
  for (const char* part : {"24 x 24 x 24", "uint8", "suggested isovalue", "access", "nrrd"})
    EXPECT_THAT(text, HasSubstr(part));
}

}  // namespace
}  // namespace voxweld::testing
