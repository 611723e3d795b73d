#include "tests/pipeline/run/scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// Bricks are the partition's, and so are their counts; the config has the directories in it, the
// stages what was done when.
std::string essence(nlohmann::json manifest) {
  for (const char* key : {"bricks", "active_bricks", "collapsed_above_bricks"})
    manifest["counts"].erase(key);
  for (const char* key : {"config", "stages", "input", "made_by"}) manifest.erase(key);
  return manifest.dump();
}

}  // namespace

std::string text_of_file(const fs::path& path) {
  const auto bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Tree output_tree(const fs::path& output) {
  Tree tree;
  if (!fs::exists(output)) return tree;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), output).string();
    if (name == "report.html") continue;  // it has times in it
    if (name == "manifest.json")
      tree["manifest"] = essence(nlohmann::json::parse(text_of_file(entry.path())));
    else
      tree[name] = to_hex(hash_bytes(read_whole_file(entry.path())));
  }
  return tree;
}

std::string difference(const Tree& expected, const Tree& found) {
  std::string text;
  for (const auto& [name, hash] : expected) {
    const auto other = found.find(name);
    if (other == found.end()) {
      text += name + " is missing\n";
    } else if (other->second != hash) {
      text += name + " differs";
      text += name == "manifest" ? ": " + hash + "\n  and " + other->second + "\n" : "\n";
    }
  }
  for (const auto& [name, hash] : found)
    if (!expected.contains(name)) text += name + " is too much\n";
  return text;
}

RawVolume noise_volume(Index3 size, unsigned seed) {
  std::mt19937 random(seed);
  return volume_of(size, [&](Index3) { return static_cast<int>(random() & 255); });
}

Scene::Scene(const std::string& phantom, std::int64_t size) : volume_(directory_ / "volume.nrrd") {
  const ProgramResult made = run_voxweld({"phantom", phantom, "--size", std::to_string(size),
                                          "--type", "uint8", "-o", volume_.string()});
  if (made.exit_code != 0) throw std::runtime_error(made.err);
  write_config("", "isovalue = 127.5\ninside = \"below\"\n");
}

Scene::Scene(const RawVolume& volume) : volume_(directory_ / "volume.raw") {
  write_volume(volume);
  write_config(
      fmt::format("format = \"raw\"\nsize = [{}, {}, {}]\ntype = \"{}\"\n"
                  "spacing = [{}, {}, {}]\n",
                  volume.size.x, volume.size.y, volume.size.z, sample_type_name(volume.type),
                  volume.spacing.x, volume.spacing.y, volume.spacing.z),
      fmt::format("isovalue = {}\n", volume.isovalue));
}

void Scene::write_volume(const RawVolume& volume) const {
  // In place, as another program would: the reader sees a new time and, it may be, a new size.
  std::ofstream out(volume_, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(volume.samples.data()),
            static_cast<std::streamsize>(volume.samples.size()));
}

void Scene::write_config(const std::string& input, const std::string& surface) const {
  std::ofstream out(config());
  out << "[input]\npath = \"" << volume_.filename().string() << "\"\n"
      << input << "\n[surface]\n"
      << surface << "\n[simplify]\nrefine = \"off\"\n\n[run]\nthreads = 2\n";
}

fs::path Scene::work(const std::string& name) const {
  return directory_ / (name + ".work");
}

fs::path Scene::output(const std::string& name) const {
  return directory_ / (name + ".mesh");
}

Settings Scene::in(const std::string& name) const {
  return {"work.directory=" + work(name).string(), "output.directory=" + output(name).string()};
}

ProgramResult Scene::command(const std::string& command, const Settings& settings,
                             std::optional<Stop> stop) const {
  // Reports have tests of their own.
  const Settings without = command == "run" ? Settings{"output.report=false"} : Settings{};
  return run_voxweld(Arguments{command, config().string(), "--log-level", "info"} +
                         set_options(without + settings),
                     stop);
}

Tree Scene::clean_tree(const Settings& settings) const {
  forget("clean");
  const ProgramResult result = run_in("clean", settings);
  VOXWELD_EXPECT_DONE(result);
  Tree tree = output_tree(output("clean"));
  EXPECT_TRUE(tree.contains("manifest"));
  forget("clean");
  return tree;
}

Tree Scene::expect_one_tree(const Settings& common, const std::vector<Settings>& variants) const {
  const Tree first = clean_tree(common);
  for (const Settings& variant : variants)
    EXPECT_EQ(difference(first, clean_tree(common + variant)), "")
        << ::testing::PrintToString(variant);
  return first;
}

void Scene::forget(const std::string& name) const {
  fs::remove_all(work(name));
  fs::remove_all(output(name));
}

void Scene::forget_stages(const std::vector<std::string>& stages) const {
  for (const auto& entry : fs::directory_iterator(work()))
    for (const std::string& stage : stages)
      if (entry.path().filename().string().starts_with(stage + "-")) fs::remove_all(entry.path());
}

VerifyReport expect_good(const fs::path& output) {
  VerifyReport report = verify_output(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  return report;
}

void expect_says(const ProgramResult& result, const std::string& words) {
  EXPECT_THAT(result.err, ::testing::HasSubstr(words));
}

void expect_refused(const ProgramResult& result, const std::string& words, int exit_code) {
  EXPECT_EQ(result.exit_code, exit_code);
  expect_says(result, words);
}

double enclosed_volume(const DecodedMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t i) {
      const auto& p = mesh.positions[t[i]];
      return Vec3{p[0], p[1], p[2]};
    };
    six += dot(at(0), cross(at(1), at(2)));
  }
  return six / 6;
}

Environment watched(const Scene& scene,
                    std::vector<std::pair<std::string, std::string>> variables) {
  const char* sanitizer = std::getenv("ASAN_OPTIONS");  // it wants to be loaded first
  variables.insert(variables.end(),
                   {{"ASAN_OPTIONS", fmt::format("{}:verify_asan_link_order=0",
                                                 sanitizer == nullptr ? "" : sanitizer)},
                    {"LD_PRELOAD", program_path().parent_path() / "commit_points.so"},
                    {"VOXWELD_POINTS_BELOW", scene.directory()}});
  return Environment(std::move(variables));
}

nlohmann::json manifest_of(const fs::path& output) {
  return nlohmann::json::parse(text_of_file(output / "manifest.json"));
}

std::map<std::string, std::uint64_t> units_run(const fs::path& output) {
  std::map<std::string, std::uint64_t> units;
  const nlohmann::json manifest = manifest_of(output);
  for (const auto& stage : manifest.at("stages"))
    units[stage.at("stage")] += stage.at("ran").get<std::uint64_t>();
  return units;
}

std::vector<fs::path> files_ending(const fs::path& root, const std::string& ending) {
  std::vector<fs::path> found;
  if (!fs::exists(root)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.is_regular_file() && entry.path().filename().string().ends_with(ending))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<fs::path> temporary_files(const fs::path& root) {
  std::vector<fs::path> found;
  if (!fs::exists(root)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.path().filename().string().find(".tmp-") != std::string::npos)
      found.push_back(entry.path());
  return found;
}

}  // namespace voxweld::testing
