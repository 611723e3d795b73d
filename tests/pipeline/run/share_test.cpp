// Tasks: the stages done in shares, as a batch system would run them, leave what one run leaves.
#include <fstream>
#include <thread>

#include "storage/artifact/shard_artifact.h"
#include "storage/manifest/task_report.h"
#include "storage/support/error.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

const Settings pieces = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};
const Settings copied_pieces = pieces + Settings{"work.copy=true"};

ProgramResult share(const Scene& scene, const std::string& stage, const Settings& settings,
                    const std::vector<std::string>& options) {
  return scene.command_with(stage, settings + scene.in("shares"), options);
}

void run_in_shares(const Scene& scene, const Settings& settings, int parts, bool reverse) {
  const auto all_parts = [&](const std::string& stage) {
    for (int i = 0; i < parts; ++i) {
      const int part = reverse ? parts - 1 - i : i;
      VOXWELD_EXPECT_DONE(share(scene, stage, settings,
                                {"--part", std::to_string(part) + "/" + std::to_string(parts)}));
    }
  };
  all_parts("ingest");
  VOXWELD_EXPECT_DONE(share(scene, "ingest", settings, {}));  // what belongs to the whole
  all_parts("build");
  VOXWELD_EXPECT_DONE(share(scene, "merge", settings, {}));
  all_parts("stitch");
  all_parts("encode");
  VOXWELD_EXPECT_DONE(share(scene, "encode", settings, {}));
}

TEST(Share, AllSharesAreTheWhole) {
  const Scene scene("porous", 70);
  for (const Settings& settings : {pieces, copied_pieces}) {
    const Tree whole = scene.clean_tree(settings);
    run_in_shares(scene, settings, 5, settings == copied_pieces);
    EXPECT_EQ(difference(whole, output_tree(scene.output("shares"))), "");
    // And nothing of it was done a second time by the closing commands.
    for (const auto& [stage, ran] : units_run(scene.output("shares"))) EXPECT_EQ(ran, 0u) << stage;
  }
}

TEST(Share, OfAnInputThatIsReadSliceBySlice) {
  const Scene scene("porous", 70);
  // A gzip stream: each share spools the slices it needs, and leaves no spool behind.
  const auto packed = scene.directory() / "packed.nrrd";
  const auto raw = read_whole_file(scene.volume());
  std::string text(reinterpret_cast<const char*>(raw.data()), raw.size());
  const std::size_t body = text.find("\n\n") + 2;
  std::string header = text.substr(0, body);
  header.replace(header.find("encoding: raw"), 13, "encoding: gzip");
  std::ofstream(scene.directory() / "body.raw", std::ios::binary) << text.substr(body);
  ASSERT_EQ(std::system(("gzip -kf " + (scene.directory() / "body.raw").string()).c_str()), 0);
  const auto gz = read_whole_file(scene.directory() / "body.raw.gz");
  std::ofstream(packed, std::ios::binary)
      << header << std::string(reinterpret_cast<const char*>(gz.data()), gz.size());
  const Settings settings = pieces + Settings{"input.path=" + packed.string()};
  const Tree whole = scene.clean_tree(settings);
  run_in_shares(scene, settings, 3, false);
  EXPECT_EQ(difference(whole, output_tree(scene.output("shares"))), "");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scene.work("shares")))
    EXPECT_FALSE(entry.path().filename().string().starts_with("spool-")) << entry.path();
}

TEST(Share, TwoCopiesAtOnceAreHarmless) {
  const Scene scene("porous", 70);
  const Tree whole = scene.clean_tree(copied_pieces);
  for (const char* stage : {"ingest", "build", "merge", "stitch", "encode"}) {
    std::vector<ProgramResult> results(3);
    {
      std::vector<std::jthread> copies;
      for (ProgramResult& result : results)
        copies.emplace_back([&] {
          const bool whole_stage = std::string(stage) == "merge";
          result = share(
              scene, stage, copied_pieces,
              whole_stage ? std::vector<std::string>{} : std::vector<std::string>{"--part", "0/1"});
        });
    }
    for (const ProgramResult& result : results) VOXWELD_EXPECT_DONE(result);
    VOXWELD_EXPECT_DONE(share(scene, stage, copied_pieces, {}));
  }
  EXPECT_EQ(difference(whole, output_tree(scene.output("shares"))), "");
  EXPECT_TRUE(temporary_files(scene.work("shares")).empty());
}

TEST(Share, DoesItsUnitsAndNoOther) {
  const Scene scene("porous", 70);
  VOXWELD_EXPECT_DONE(share(scene, "build", pieces, {"--shards", "1,3-4"}));
  EXPECT_EQ(files_ending(scene.work("shares"), ".octree").size(), 3u);
}

TEST(Share, SaysWhatIsWrongWithTheNumbers) {
  const Scene scene("porous", 40);
  const auto expect_refused = [&](const std::string& stage, const std::string& option,
                                  const std::string& value, const std::string& why) {
    SCOPED_TRACE(value);
    testing::expect_refused(share(scene, stage, pieces, {option, value}), why);
  };
  expect_refused("build", "--shards", "0-99", "stage build has 8 of them");
  for (const char* list : {"a", "3-1", "1,1", "1,,2", "-", "1-", " 1", "99999999999999999999"})
    expect_refused("build", "--shards", list, "expected numbers and ranges in rising order");
  for (const char* part : {"1", "1/1", "4/3", "-1/3", "0/0", "1/x"})
    expect_refused("build", "--part", part, "expected K/N");
  expect_refused("stitch", "--tiles", "0", "`voxweld merge CONFIG`");
}

TEST(Share, ReportsHowItWent) {
  const Scene scene("porous", 40);
  const auto path = scene.directory() / "report.json";
  VOXWELD_EXPECT_DONE(share(scene, "build", pieces, {"--part", "0/2", "--report", path.string()}));
  const auto report = read_task_report(path);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->stage, "build");
  EXPECT_EQ(report->units, 4u);
  EXPECT_EQ(report->exit_code, 0);
  EXPECT_GT(report->peak_resident, 1u << 20);
  EXPECT_NE(report->provenance.find("\"host\""), std::string::npos);

  std::filesystem::resize_file(scene.volume(), std::filesystem::file_size(scene.volume()) / 2);
  EXPECT_EQ(share(scene, "build", pieces, {"--part", "1/2", "--report", path.string()}).exit_code,
            2);
  EXPECT_EQ(read_task_report(path)->exit_code, 2);
  EXPECT_NE(read_task_report(path)->failures.at(0).message.find("volume.nrrd"), std::string::npos);
}

// The top tree was merged from other octrees than lie there now: a tile's share says so.
TEST(Share, AStaleTopTreeIsNotStitchedFrom) {
  const RawVolume volume = noise_volume({40, 40, 40}, 3);
  const Scene scene(volume);
  run_in_shares(scene, pieces, 1, false);
  RawVolume other = volume;
  for (std::byte& sample : other.samples) sample ^= std::byte{255};
  scene.write_volume(other);
  VOXWELD_EXPECT_DONE(share(scene, "build", pieces, {"--part", "0/1"}));
  const ProgramResult result = share(scene, "stitch", pieces, {"--tiles", "0"});
  expect_refused(result, "was merged from another", 1);
}

TEST(Share, ArtifactsSayWhoMadeThem) {
  const Scene scene("porous", 40);
  setenv("SLURM_JOB_ID", "4711", 1);
  VOXWELD_EXPECT_DONE(share(scene, "build", pieces, {"--shards", "0"}));
  unsetenv("SLURM_JOB_ID");
  const auto files = files_ending(scene.work("shares"), ".octree");
  ASSERT_EQ(files.size(), 1u);
  const auto made = nlohmann::json::parse(ShardArtifact(files[0]).provenance());
  EXPECT_EQ(made.at("slurm").at("job"), "4711");
  EXPECT_EQ(made.at("config").get<std::string>().size(), 32u);
  EXPECT_NE(made.at("time").get<std::string>().find('T'), std::string::npos);
}

}  // namespace
}  // namespace voxweld::testing
