// [[filter]] tables, end to end: what comes out of the whole program, whatever the partition, and
// how little is done again.
#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <thread>

#include "tests/pipeline/run/edit_scene.h"
#include "tests/support/mesh_check.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* smoothing = "[[filter]]\ntype = \"gaussian\"\nsigma = [1.2, 0.7, 1.0]\n";
constexpr const char* keep_largest = "[[filter]]\ntype = \"keep\"\n";
constexpr Index3 balls_size = {70, 50, 44};

double squared(double v) {
  return v * v;
}

// Two balls apart, one with a void in it, and a speck; bright on dark, with blurred borders.
std::uint8_t balls_at(Index3 p) {
  const auto ball = [&](Vec3 centre, double radius) {
    const double distance = std::sqrt(squared(static_cast<double>(p.x) - centre.x) +
                                      squared(static_cast<double>(p.y) - centre.y) +
                                      squared(static_cast<double>(p.z) - centre.z));
    return radius - distance;
  };
  double inside = std::max(ball({22, 24, 21}, 15), ball({55, 26, 20}, 9));
  inside = std::max(inside, ball({62, 42, 38}, 2.2));
  inside = std::min(inside, -ball({24, 22, 20}, 5));
  return static_cast<std::uint8_t>(std::clamp(128 + 60 * inside, 20.0, 220.0));
}

RawVolume balls() {
  return volume_of(balls_size, balls_at);
}

double volume_of_ball(double radius) {
  return 4.0 / 3 * std::numbers::pi * radius * radius * radius;
}

DecodedMesh mesh_of(const Scene& scene) {
  expect_good(scene.output());
  return load_mesh(scene.output() / "mesh.drc");
}

std::size_t components(const Scene& scene) {
  const DecodedMesh mesh = mesh_of(scene);
  return connected_components(mesh.triangles);
}

Settings cut(int brick, int shard, int chunk, const std::string& copy, int threads) {
  return {fmt::format("work.brick={}", brick), fmt::format("work.shard={}", shard),
          fmt::format("work.chunk={}", chunk), "work.copy=" + copy,
          fmt::format("run.threads={}", threads)};
}

// Every kind of filter at once; a sample of the result depends on far ones.
TEST(Filter, AnyPartitionGivesTheSameBytes) {
  const Scene scene(noise_volume({61, 53, 47}, 3));
  const EditScene filters(scene);
  const std::string chain = fmt::format(
      "{}[[filter]]\ntype = \"median\"\nradius = [1, 2, 1]\n"
      "[[filter]]\ntype = \"keep\"\nmin_voxels = 20\n"
      "[[filter]]\ntype = \"fill\"\nmax_voxels = 30\n"
      "[[filter]]\ntype = \"permute\"\norder = \"zxy\"\n"
      "[[filter]]\ntype = \"mean\"\nradius = 1\nsample_type = \"float32\"\n"
      "[[filter]]\ntype = \"flip\"\naxes = \"xz\"\n",
      smoothing);
  filters.set(chain);
  scene.expect_one_tree({}, {cut(16, 1, 8, "true", 1), cut(16, 2, 16, "false", 2),
                             cut(32, 1, 32, "auto", 2), cut(64, 2, 32, "true", 2)});
}

TEST(Filter, KeepLeavesTheLargestPieceAndFillClosesItsVoid) {
  const Scene scene(balls());
  const EditScene filters(scene);
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(components(scene), 4U);  // three solids and a void's wall
  filters.set(keep_largest);
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(components(scene), 2U);
  const double hollow = volume_of_ball(15) - volume_of_ball(5);
  EXPECT_NEAR(enclosed_volume(mesh_of(scene)), hollow, 0.012 * hollow);
  filters.set(
      "[[filter]]\ntype = \"keep\"\nmin_voxels = 1000\n"
      "[[filter]]\ntype = \"fill\"\nmax_voxels = 1000\n");
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(components(scene), 2U);
  const double both = volume_of_ball(15) + volume_of_ball(9);
  EXPECT_NEAR(enclosed_volume(mesh_of(scene)), both, 0.01 * both);
}

// What is dark is inside: pieces and voids change places.
TEST(Filter, KeepGoesByTheSideThatIsInside) {
  RawVolume volume = balls();
  for (std::byte& sample : volume.samples)
    sample = static_cast<std::byte>(255 - static_cast<int>(sample));
  const Scene scene(volume);
  const EditScene filters(scene);
  filters.set(keep_largest);
  VOXWELD_EXPECT_DONE(scene.run({"surface.inside=below", "surface.isovalue=127"}));
  EXPECT_EQ(components(scene), 2U);
}

TEST(Filter, TheIsovalueIsChosenOnceForPiecesAndSurface) {
  const Scene scene(balls());
  const EditScene filters(scene);
  filters.set(keep_largest);
  const ProgramResult chosen = scene.run({"surface.isovalue=otsu"});
  VOXWELD_EXPECT_DONE(chosen);
  const std::string words = "surface.isovalue = \"otsu\": ";
  const double value = std::stod(chosen.err.substr(chosen.err.find(words) + words.size()));
  const Tree tree = output_tree(scene.output());
  scene.forget();
  VOXWELD_EXPECT_DONE(scene.run({fmt::format("surface.isovalue={}", value)}));
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
}

// As a stream: gzip NRRD.
void write_stream(const fs::path& path, const RawVolume& volume) {
  std::ofstream(path) << fmt::format(
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {} {} {}\nspacings: 1 1 1\nencoding: gzip\n\n",
      balls_size.x, balls_size.y, balls_size.z);
  gzFile out = gzopen(path.c_str(), "ab");
  gzwrite(out, volume.samples.data(), static_cast<unsigned>(volume.samples.size()));
  gzclose(out);
}

// A stream is copied before it is filtered, and what comes out is the same.
TEST(Filter, OfAStreamIsThatOfTheSamplesInPlace) {
  const RawVolume volume = balls();
  const Scene scene(volume);
  const EditScene filters(scene);
  const std::string turned = "[[filter]]\ntype = \"flip\"\naxes = \"z\"\n";
  const fs::path path = scene.directory() / "stream.nrrd";
  write_stream(path, volume);
  const fs::path config = scene.directory() / "stream.toml";
  for (const std::string& chain :
       {std::string(smoothing) + turned, turned + keep_largest, turned}) {
    filters.set(chain);
    std::ofstream(config) << "[input]\npath = \"stream.nrrd\"\n[surface]\nisovalue = 128\n"
                             "[simplify]\nrefine = \"off\"\n"
                          << chain;
    VOXWELD_EXPECT_DONE(scene.run());
    VOXWELD_EXPECT_DONE(run_voxweld({"run", config.string()}));
    EXPECT_EQ(load_mesh(scene.output() / "mesh.drc").positions,
              load_mesh(scene.directory() / "stream.mesh" / "mesh.drc").positions)
        << chain;
    EXPECT_TRUE(files_ending(scene.directory(), "spool-").empty());
  }
}

// The mesh of a coarser volume made by hand is the same; its place in the world is that of the
// middles of what is taken together.
TEST(Filter, DownsampleGivesTheCoarserVolumeInItsPlace) {
  const RawVolume fine = balls();
  const Index3 half = divide(balls_size, splat(2));
  RawVolume coarse = volume_of(half, [&](Index3 p) {
    int sum = 0;
    each_index(splat(2), [&](Index3 d) {
      sum += static_cast<int>(fine.samples[static_cast<std::size_t>(fine.index(p * 2 + d))]);
    });
    return static_cast<std::int64_t>(std::nearbyint(sum / 8.0));
  });
  coarse.spacing = {2, 2, 2};
  const Scene by_hand(coarse), scene(fine);
  const EditScene filters(scene);
  filters.set("[[filter]]\ntype = \"downsample\"\n");
  VOXWELD_EXPECT_DONE(by_hand.run());
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(mesh_of(scene).positions, mesh_of(by_hand).positions);
  const auto frame = manifest_of(scene.output()).at("frame");
  EXPECT_EQ(frame.at("origin"), (nlohmann::json{0.5, 0.5, 0.5}));
  EXPECT_EQ(frame.at("spacing"), (nlohmann::json{2.0, 2.0, 2.0}));
}

// Whatever is turned, the world stays where it is.
TEST(Filter, TurnedAxesKeepTheirPlaceInTheWorld) {
  const Scene scene(balls());
  const EditScene filters(scene);
  const auto world = [&](const std::string& chain) {
    filters.set(chain);
    VOXWELD_EXPECT_DONE(scene.run({"simplify.enabled=false"}));
    const auto frame = manifest_of(scene.output()).at("frame");
    const auto number = [&](const auto& list, int i) { return list.at(i).template get<double>(); };
    Vec3 lo{1e9, 1e9, 1e9}, hi = Vec3{} - lo;
    for (const auto& p : mesh_of(scene).positions) {
      Vec3 at;
      for (int row = 0; row < 3; ++row) {
        at[row] = number(frame.at("origin"), row);
        for (int axis = 0; axis < 3; ++axis)
          at[row] += number(frame.at("direction").at(axis), row) *
                     static_cast<double>(p[static_cast<std::size_t>(axis)]);
      }
      lo = min(lo, at);
      hi = max(hi, at);
    }
    return std::array<Vec3, 2>{lo, hi};
  };
  const auto plain = world("");
  for (const char* chain : {"[[filter]]\ntype = \"flip\"\naxes = \"xy\"\n",
                            "[[filter]]\ntype = \"permute\"\norder = \"yzx\"\n"}) {
    const auto turned = world(chain);
    for (int end = 0; end < 2; ++end)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(turned[static_cast<std::size_t>(end)][axis],
                    plain[static_cast<std::size_t>(end)][axis], 0.05)
            << chain;
  }
}

// Masks are volumes of any format; here one that has to be copied before boxes of it can be read.
TEST(Filter, AMaskLeavesWhatItCovers) {
  const Scene scene(balls());
  const EditScene filters(scene);
  const fs::path path = scene.directory() / "mask.nrrd";
  std::ofstream(path) << fmt::format(
      "NRRD0004\ntype: ushort\nendian: little\ndimension: 3\nsizes: {} {} {}\nspacings: 1 1 1\n"
      "encoding: gzip\n\n",
      balls_size.x, balls_size.y, balls_size.z);
  std::vector<std::uint16_t> labels;
  each_index(balls_size, [&](Index3 p) {
    labels.push_back(p.x < 42 ? std::uint16_t{7} : p.y < 36 ? std::uint16_t{300} : std::uint16_t{});
  });
  gzFile out = gzopen(path.c_str(), "ab");
  gzwrite(out, labels.data(), static_cast<unsigned>(2 * labels.size()));
  gzclose(out);
  const std::string mask = "[[filter]]\ntype = \"mask\"\npath = \"mask.nrrd\"\noutside = 20\n";
  filters.set(mask);
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(components(scene), 3U);  // the speck is gone
  filters.set(mask + "values = [\"200-400\"]\n");
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(components(scene), 1U);
  EXPECT_NEAR(enclosed_volume(mesh_of(scene)), volume_of_ball(9), 0.01 * volume_of_ball(9));

  // A mask that says it lies elsewhere is told of.
  std::string header = text_of_file(path);
  const std::string plain = header, spacings = "spacings: 1 1 1\n";
  header.replace(header.find(spacings), spacings.size(),
                 "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (3,0,0)\n");
  std::ofstream(path, std::ios::binary) << header;
  const ProgramResult elsewhere = scene.run({"input.spacing=2"});
  VOXWELD_EXPECT_DONE(elsewhere);
  expect_says(elsewhere, "elsewhere in the world");
  std::ofstream(path, std::ios::binary) << plain;

  filters.set("[[filter]]\ntype = \"mask\"\npath = \"scene.toml\"\n");
  expect_refused(scene.run(), "filter 1: missing key outside");
  filters.set("[[filter]]\ntype = \"mask\"\npath = \"scene.toml\"\noutside = 0\n");
  expect_refused(scene.run(), "filter 1: the mask cannot be opened");
  filters.set("[[filter]]\ntype = \"window\"\nclip = [0, 100]\n");
  expect_refused(scene.run(), "filtered: the values run from 20 to 100");

  filters.set("[[filter]]\ntype = \"downsample\"\n" + mask);
  expect_refused(scene.run(), "expected the same size");
  filters.set("[[filter]]\ntype = \"mask\"\npath = \"mask.nrrd\"\noutside = 300\n");
  expect_refused(scene.run(), "samples of type uint8 cannot be that");
}

TEST(Filter, WhatChangedIsDoneAgainAndNoMore) {
  const Scene scene(balls());
  const EditScene filters(scene);
  const std::string chain = std::string(smoothing) + keep_largest;
  filters.set(chain);
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree tree = output_tree(scene.output());
  VOXWELD_EXPECT_DONE(scene.run());
  for (const auto& [stage, units] : units_run(scene.output())) EXPECT_EQ(units, 0U) << stage;
  filters.set(keep_largest);
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_NE(difference(tree, output_tree(scene.output())), "");
  filters.set(chain);
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
  const ProgramResult clean = run_voxweld({"clean", scene.config().string()});
  VOXWELD_EXPECT_DONE(clean);
  VOXWELD_EXPECT_DONE(scene.run());
  for (const auto& [stage, units] : units_run(scene.output())) EXPECT_EQ(units, 0U) << stage;
}

// A volume that is written anew gives a new result, also where all of it decides.
TEST(Filter, ANewVolumeIsFilteredAnew) {
  const Scene scene(balls());
  const EditScene filters(scene);
  filters.set(keep_largest);
  VOXWELD_EXPECT_DONE(scene.run());
  RawVolume volume = balls();
  each_index(balls_size, [&](Index3 p) {  // the large ball is cut in two by a plane
    if (p.x > 18 && p.x < 25)
      volume.samples[static_cast<std::size_t>(volume.index(p))] = std::byte{20};
  });
  scene.write_volume(volume);
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree tree = output_tree(scene.output());
  scene.forget();
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
}

TEST(Filter, WhatWasFoundOfPiecesIsMadeAgainWhereItIsDamaged) {
  const Scene scene(balls());
  const EditScene filters(scene);
  filters.set(keep_largest);
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree tree = output_tree(scene.output());
  const std::vector<fs::path> found = files_ending(scene.work(), "pieces");
  ASSERT_EQ(found.size(), 1U);
  const ProgramResult told = run_voxweld({"info", "--json", found.front().string()});
  VOXWELD_EXPECT_DONE(told);
  const auto facts = nlohmann::json::parse(told.out);
  EXPECT_EQ(facts.at("filter"), "keep");
  EXPECT_EQ(facts.at("pieces"), 3);
  EXPECT_EQ(facts.at("changed_pieces"), 2);
  const std::string whole = text_of_file(found.front());
  for (const std::size_t at : {whole.size() / 2, whole.size() - 3}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    scene.forget_stages({"build", "merge", "stitch", "encode"});
    for (const fs::path& shard : files_ending(scene.work(), ".record")) fs::remove(shard);
    std::ofstream(found.front(), std::ios::binary) << damaged;
    VOXWELD_EXPECT_DONE(scene.run());
    EXPECT_EQ(difference(tree, output_tree(scene.output())), "") << at;
  }
}

TEST(Filter, SharesOfIngestAreFiltered) {
  const Scene scene(balls());
  const EditScene filters(scene);
  filters.set(std::string(smoothing) + keep_largest);
  const Settings settings = cut(16, 1, 16, "auto", 2);
  const Tree tree = scene.clean_tree(settings);
  scene.forget();
  for (int part = 0; part < 3; ++part)
    VOXWELD_EXPECT_DONE(
        scene.command_with("ingest", settings, {"--part", fmt::format("{}/3", part)}));
  VOXWELD_EXPECT_DONE(scene.run(settings));
  EXPECT_EQ(units_run(scene.output()).at("ingest"), 0U);
  EXPECT_EQ(difference(tree, output_tree(scene.output())), "");
}

// As tasks of a cluster that nobody drives: each may be the first to need what comes before.
TEST(Filter, SharesAtOnceDoOnceWhatComesBefore) {
  const Scene scene(balls());
  write_stream(scene.directory() / "stream.nrrd", balls());
  const std::string config = (scene.directory() / "stream.toml").string();
  std::ofstream(config) << "[input]\npath = \"stream.nrrd\"\n[surface]\nisovalue = 128\n"
                        << "[work]\nbrick = 16\nshard = 1\nchunk = 16\n"
                        << smoothing << keep_largest;
  VOXWELD_EXPECT_DONE(run_voxweld({"run", config}));
  const Tree tree = output_tree(scene.directory() / "stream.mesh");
  for (int turn = 0; turn < 5; ++turn) {
    for (const char* folder : {"stream.work", "stream.mesh"})
      fs::remove_all(scene.directory() / folder);
    std::vector<ProgramResult> results(4);
    {
      std::vector<std::jthread> tasks;
      for (std::size_t part = 0; part < results.size(); ++part)
        tasks.emplace_back([&, part] {
          results[part] = run_voxweld({"ingest", config, "--part", fmt::format("{}/4", part)});
        });
    }
    for (const ProgramResult& result : results) VOXWELD_EXPECT_DONE(result);
    VOXWELD_EXPECT_DONE(run_voxweld({"run", config}));
    EXPECT_EQ(difference(tree, output_tree(scene.directory() / "stream.mesh")), "");
  }
}

TEST(Filter, LabelsAreMadeCoarserByWhatMostHave) {
  const Scene scene(volume_of(balls_size, [](Index3 p) {
    return p.x < 30 ? 0 : p.y < 25 ? 3 : 9;
  }));
  const EditScene filters(scene);
  filters.set("[[filter]]\ntype = \"downsample\"\nmethod = \"mode\"\n");
  VOXWELD_EXPECT_DONE(scene.run({"labels.mode=each"}));
  EXPECT_EQ(files_ending(scene.output() / "labels", ".drc").size(), 2U);
}

}  // namespace
}  // namespace voxweld::testing
