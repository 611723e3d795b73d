// Exports of runs, read back as clients read them.
#include "pipeline/neuroglancer/neuroglancer.h"

#include <fmt/format.h>

#include <map>

#include "pipeline/neuroglancer/folder_check.h"
#include "pipeline/neuroglancer/folder_reader.h"
#include "pipeline/output/load.h"
#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_measure.h"
#include "storage/manifest/manifest.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> with_levels = {"--set", "output.levels=\"auto\"",
                                              "--set", "output.tile_vertices=1024",
                                              "--set", "simplify.tolerance=0.02"};

// A run of a phantom, in `<name>.mesh`.
std::string run_phantom(const Workplace& place, const std::string& kind,
                        std::vector<std::string> settings, std::vector<std::string> more = {}) {
  std::vector<std::string> make = {"phantom", kind, "-o", place.at("v.nrrd"), "--force"};
  make.insert(make.end(), more.begin(), more.end());
  place.run(make);
  std::vector<std::string> init = {"init", place.at("v.nrrd"), "-o", place.at("v.toml"), "--force"};
  if (kind == "labels") init.push_back("--labels");
  place.run(init);
  std::vector<std::string> run = {"run", place.at("v.toml"), "--set", "output.report=false"};
  run.insert(run.end(), settings.begin(), settings.end());
  place.run(run);
  return place.at("v.mesh");
}

// In the mesh's unit, cubed.
double source_volume(const std::string& output, int level) {
  const Manifest manifest = read_manifest(std::filesystem::path(output) / manifest_name);
  MeshMeasure sum;
  for_each_mesh(
      output,
      [&](const DecodedMesh& mesh, std::optional<Material>) {
        const LatticeMesh welded = weld(mesh, manifest.lattice);
        sum += measure(welded.positions, welded.triangles);
      },
      mesh_writers(), level);
  return enclosed_volume(sum, manifest.lattice);
}

std::map<std::string, std::string> bytes_below(const std::string& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      all[std::filesystem::relative(entry.path(), folder).string()] = read_bytes(entry.path());
  return all;
}

FolderReport good_report(const std::string& folder) {
  FolderReport report = check_folder(folder);
  EXPECT_THAT(report.problems, ElementsAre());
  return report;
}

std::map<std::uint64_t, LabelRecord> labels_of(const std::string& output) {
  std::map<std::uint64_t, LabelRecord> labels;
  LabelListReader reader(std::filesystem::path(output) / labels_name);
  while (auto label = reader.next()) labels[label->label] = *label;
  return labels;
}

TEST(NeuroglancerExport, EachLevelIsClosedAndHoldsWhatTheMeshHolds) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", with_levels,
                                       {"--size", "96", "--spacing", "0.5", "--unit", "um"});
  const NeuroglancerTotals totals =
      write_neuroglancer(mesh, place.at("ng"), {.fragment_triangles = 1000});
  ASSERT_GE(totals.levels, 2);
  EXPECT_EQ(totals.objects, 1u);
  const FolderReport report = good_report(place.at("ng"));
  ASSERT_EQ(report.objects.size(), 1u);
  const ObjectReport& object = report.objects[0];
  EXPECT_EQ(object.id, 1u);
  ASSERT_EQ(object.levels.size(), static_cast<std::size_t>(totals.levels));
  EXPECT_GT(object.levels[0].fragments, 8u);
  for (int level = 0; level < totals.levels; ++level) {
    const LevelReport& one = object.levels[static_cast<std::size_t>(level)];
    EXPECT_EQ(one.open_edges, 0u) << level;
    EXPECT_NEAR(one.volume / source_volume(mesh, level), 1, 1e-5) << level;
    if (level == 0) continue;
    EXPECT_LT(one.triangles, object.levels[static_cast<std::size_t>(level) - 1].triangles);
  }
  const FragmentIndex index = FolderReader(place.at("ng")).object(1).index;
  for (std::size_t level = 1; level < index.levels.size(); ++level)
    EXPECT_GT(index.levels[level].scale, index.levels[level - 1].scale);
  const auto info = nlohmann::json::parse(read_bytes(place.at("ng") + "/info"));
  EXPECT_EQ(info.at("@type"), "neuroglancer_multilod_draco");
  EXPECT_EQ(info.at("vertex_quantization_bits"), 16);
  EXPECT_EQ(info.at("transform"), (nlohmann::json{1e3, 0, 0, 0, 0, 1e3, 0, 0, 0, 0, 1e3, 0}));
}

// The corners of the mesh itself are not rounded: where nothing is cut all triangles are the same.
TEST(NeuroglancerExport, KeepsTheMeshWhereNothingIsCut) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", {}, {"--size", "40"});
  write_neuroglancer(mesh, place.at("ng"), {});
  const FolderReader reader(place.at("ng"));
  const ExportedObject object = reader.object(1);
  ASSERT_EQ(object.index.levels.size(), 1u);
  ASSERT_EQ(object.index.levels[0].fragments.size(), 1u);
  EXPECT_EQ(object.index.levels[0].fragments[0].code, 0u);
  const FragmentMesh read = reader.fragment(object, object.index.levels[0].fragments[0], 0);
  TriangleDigest expected, found;
  const Manifest manifest = read_manifest(std::filesystem::path(mesh) / manifest_name);
  for_each_mesh(mesh, [&](const DecodedMesh& tile, std::optional<Material>) {
    expected += digest(weld(tile, manifest.lattice));
  });
  for (const auto& t : read.triangles)
    found += digest({read.positions[t[0]], read.positions[t[1]], read.positions[t[2]]}, nullptr);
  EXPECT_EQ(found, expected);
}

TEST(NeuroglancerExport, IsTheSameOnAnyNumberOfThreads) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", with_levels, {"--size", "96"});
  for (const int threads : {1, 3})
    write_neuroglancer(mesh, place.at("ng" + std::to_string(threads)),
                       {.threads = threads, .fragment_triangles = 500});
  EXPECT_EQ(bytes_below(place.at("ng1")), bytes_below(place.at("ng3")));
}

TEST(NeuroglancerExport, HasAnObjectForEachLabel) {
  for (const char* mode : {"each", "shared"}) {
    const Workplace place;
    std::vector<std::string> settings = {"--set", fmt::format("labels.mode=\"{}\"", mode)};
    if (mode == std::string("shared"))
      settings.insert(settings.end(), with_levels.begin(), with_levels.end());
    const std::string mesh = run_phantom(place, "labels", settings, {"--size", "48"});
    write_neuroglancer(mesh, place.at("ng"), {.fragment_triangles = 100});
    const auto labels = labels_of(mesh);
    const FolderReport report = good_report(place.at("ng"));
    ASSERT_EQ(report.objects.size(), labels.size()) << mode;
    for (const ObjectReport& object : report.objects) {
      const LabelRecord& label = labels.at(object.id);
      // A label of few triangles has large ones, and where they are cut points are rounded.
      EXPECT_NEAR(object.levels[0].volume / *label.volume, 1, 1e-4) << mode << object.id;
      EXPECT_GE(object.levels[0].triangles, label.triangles);
    }
    const auto properties =
        nlohmann::json::parse(read_bytes(place.at("ng") + "/segment_properties/info"));
    EXPECT_EQ(properties.at("inline").at("ids").size(), labels.size());
    EXPECT_EQ(properties.at("inline").at("properties").size(), 3u);  // without names
  }
}

TEST(NeuroglancerExport, ShardsHaveTheSameObjects) {
  const Workplace place;
  const std::string mesh =
      run_phantom(place, "labels", {"--set", "labels.mode=\"each\""},
                  {"--size", "48", "--type", "uint32", "--first-label", "1000000007"});
  write_neuroglancer(mesh, place.at("files"), {});
  write_neuroglancer(mesh, place.at("shards"), {.sharded = true});
  const FolderReader files(place.at("files")), shards(place.at("shards"));
  ASSERT_TRUE(shards.sharding());
  EXPECT_GE(shards.sharding()->minishard_bits, 2);  // 216 labels, 64 to a minishard
  EXPECT_EQ(shards.ids(), files.ids());
  EXPECT_GT(files.ids().front(), 1000000000u);
  for (const std::uint64_t id : files.ids()) {
    const ExportedObject a = files.object(id), b = shards.object(id);
    EXPECT_EQ(index_bytes(a.index), index_bytes(b.index));
    const std::string shard = read_bytes(b.data);
    const std::string file = read_bytes(a.data);
    EXPECT_EQ(shard.substr(b.offset, file.size()), file) << id;
  }
  good_report(place.at("shards"));
}

TEST(NeuroglancerExport, OldFormatIsClosedInNanometres) {
  const Workplace place;
  const std::string mesh =
      run_phantom(place, "gyroid", {}, {"--size", "64", "--spacing", "2", "--unit", "nm"});
  write_neuroglancer(mesh, place.at("ng"), {.legacy = true, .fragment_triangles = 200});
  const FolderReport report = good_report(place.at("ng"));
  ASSERT_EQ(report.objects.size(), 1u);
  EXPECT_GE(report.objects[0].levels[0].fragments, 8u);
  EXPECT_NEAR(report.objects[0].levels[0].volume / source_volume(mesh, 0), 1, 1e-4);
  const auto info = nlohmann::json::parse(read_bytes(place.at("ng") + "/info"));
  EXPECT_EQ(info.at("@type"), "neuroglancer_legacy_mesh");
}

TEST(NeuroglancerExport, OpenBordersStayOpenAndAreNoProblem) {
  const Workplace place;
  const std::string mesh =
      run_phantom(place, "noise", {"--set", "surface.border=\"open\""}, {"--size", "20"});
  write_neuroglancer(mesh, place.at("ng"), {.fragment_triangles = 1000});
  EXPECT_GT(good_report(place.at("ng")).objects.at(0).levels.at(0).open_edges, 0u);
}

TEST(NeuroglancerCheck, FindsWhatIsWrong) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", with_levels, {"--size", "96"});
  write_neuroglancer(mesh, place.at("ng"), {.fragment_triangles = 500});
  const std::string index_path = place.at("ng") + "/1.index", data_path = place.at("ng") + "/1";
  const std::string index = read_bytes(index_path), data = read_bytes(data_path);
  const FragmentIndex changed = FolderReader(place.at("ng")).object(1).index;
  ASSERT_GE(changed.levels.size(), 2u);
  const auto with_index = [&](const FragmentIndex& of) {
    write_whole_file(index_path, index_bytes(of), Durability::rename_only);
    const FolderReport report = check_folder(place.at("ng"));
    write_bytes(index_path, index);
    return report.problems;
  };
  // The last fragment of the mesh itself is left out: there is a hole, and clients find it missing.
  FragmentIndex holed = changed;
  FragmentEntry& last = holed.levels[0].fragments.back();
  const std::uint32_t size = last.bytes;
  ASSERT_GT(size, 0u);
  last.bytes = 0;
  holed.levels[1].fragments.front().bytes += size;
  EXPECT_THAT(with_index(holed), Contains(HasSubstr("edges are open")));
  FragmentIndex orphaned = changed;
  orphaned.levels.back().fragments.pop_back();
  EXPECT_THAT(with_index(orphaned), Contains(HasSubstr("clients do not find")));
  FragmentIndex swapped = changed;
  std::swap(swapped.levels[0].fragments[0].code, swapped.levels[0].fragments[1].code);
  EXPECT_THAT(with_index(swapped), Contains(HasSubstr("Z-order")));
  write_bytes(data_path, data.substr(0, data.size() - 10));
  const ProgramResult result = run_voxweld({"verify", place.at("ng")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("problem: "));
  write_bytes(data_path, data);
  EXPECT_THAT(place.run({"verify", place.at("ng")}).out, HasSubstr("good"));
  place.run({"verify", place.at("ng"), "--json"});
}

TEST(NeuroglancerCommand, RefusesWhatWillNotDo) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", {}, {"--size", "24"});
  const auto with = [&](const std::string& input, const std::string& folder,
                        const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"export", input, "--neuroglancer", "-o", folder};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_THAT(place.run(with(mesh, place.at("ng"))).out,
              HasSubstr("1 object in 1 fragment of 1 level"));
  expect_refused(with(mesh, place.at("ng")), {"is not empty", "--force"});
  place.run(with(mesh, place.at("ng"), {"--force"}));
  expect_refused(with(place.at("none"), place.at("a")), {"none"});
  expect_refused(with(mesh, mesh + "/ng"), {"lies in the output directory"});
  expect_refused(with(mesh, place.at("v.toml")), {"is a file"});
  expect_refused(with(mesh, place.at("a"), {"--legacy", "--sharded"}),
                 {"--sharded and --legacy do not go together"});
  expect_refused(with(mesh, place.at("a"), {"--weld"}), {"--weld"});
  expect_refused({"export", mesh, "--sharded", "-o", place.at("a")}, {"--neuroglancer"});
  EXPECT_FALSE(std::filesystem::exists(place.at("a")));
  // Not over what is somebody else's.
  write_bytes(place.at("ng") + "/notes.txt", "mine");
  expect_refused(with(mesh, place.at("ng"), {"--force"}), {"notes.txt"});
  EXPECT_EQ(read_bytes(place.at("ng") + "/notes.txt"), "mine");
  EXPECT_TRUE(std::filesystem::exists(place.at("ng") + "/info"));
  std::filesystem::create_directory(place.at("theirs"));
  write_bytes(place.at("theirs") + "/info", R"({"@type": "neuroglancer_multilod_draco"})");
  expect_refused(with(mesh, place.at("theirs"), {"--force"}), {"has not written"});
  expect_refused(with(mesh, place.at("a"), {"--threads", "x"}),
                 {"--threads", "expected an integer of at least 0, found x"});
  expect_refused(with(first_file(mesh + "/tiles", ".drc"), place.at("a")), {"is a file"});
  // A tile of which one byte is another.
  const std::string tile = first_file(mesh + "/tiles", ".drc");
  std::string bytes = read_bytes(tile);
  bytes[bytes.size() / 2] ^= 1;
  write_bytes(tile, bytes);
  const ProgramResult damaged = run_voxweld(with(mesh, place.at("b")));
  EXPECT_NE(damaged.exit_code, 0);
  EXPECT_THAT(damaged.err, AllOf(HasSubstr(".drc"), HasSubstr("its hash")));
  EXPECT_FALSE(std::filesystem::exists(place.at("b") + "/info"));
}

TEST(NeuroglancerCommand, NeedsTiles) {
  const Workplace place;
  const std::string mesh =
      run_phantom(place, "gyroid", {"--set", "output.tiles=false"}, {"--size", "24"});
  expect_refused({"export", mesh, "--neuroglancer", "-o", place.at("ng")},
                 {"no tiles", "output.tiles"});
  EXPECT_FALSE(std::filesystem::exists(place.at("ng")));
}

TEST(NeuroglancerCommand, VerifyTakesNoOptionsOfMeshes) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "gyroid", {}, {"--size", "24"});
  place.run({"export", mesh, "--neuroglancer", "-o", place.at("ng")});
  expect_refused({"verify", place.at("ng"), "--intersections"}, {"--threads and --json"});
  expect_refused({"verify", place.at("nowhere")}, {"no such folder"});
}

// A surface that fills space has more area in a large cube than one that is flat.
TEST(NeuroglancerExport, FragmentsHaveAboutAsManyTrianglesAsAreAskedFor) {
  const Workplace place;
  const std::string mesh = run_phantom(place, "porous", with_levels, {"--size", "96"});
  for (const std::uint64_t most : {2000, 20000}) {
    const std::string folder = place.at(std::to_string(most));
    write_neuroglancer(mesh, folder, {.fragment_triangles = most});
    const FolderReader reader(folder);
    const ExportedObject object = reader.object(1);
    std::uint64_t offset = 0, largest = 0;
    for (const FragmentEntry& entry : object.index.levels[0].fragments) {
      if (entry.bytes > 0)
        largest = std::max<std::uint64_t>(largest,
                                          reader.fragment(object, entry, offset).triangles.size());
      offset += entry.bytes;
    }
    EXPECT_LT(largest, 2 * most);
  }
}

TEST(NeuroglancerCommand, CallsALabelByItsNumber) {
  const Workplace place;
  const std::string mesh =
      run_phantom(place, "labels", {"--set", "surface.label=100", "--set", "labels.mode=\"off\""},
                  {"--size", "32"});
  place.run({"export", mesh, "--neuroglancer", "-o", place.at("ng")});
  EXPECT_THAT(FolderReader(place.at("ng")).ids(), ElementsAre(100));
}

}  // namespace
}  // namespace voxweld::testing
