#include "tests/chaos/place.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr int side = 40;

// Without what differs from run to run, and the partition's counts.
std::string manifest_essence(const std::string& text) {
  nlohmann::json manifest = nlohmann::json::parse(text, nullptr, false);
  if (manifest.is_discarded() || !manifest.is_object()) return "damaged";
  if (manifest.contains("counts"))
    for (const char* key : {"bricks", "active_bricks", "collapsed_above_bricks"})
      manifest["counts"].erase(key);
  for (const char* key : {"config", "stages", "input", "made_by"}) manifest.erase(key);
  return manifest.dump();
}

// A ball with waves on it.
std::string ball_samples(double radius, double waves, double height) {
  std::string samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double dx = x - 19.5, dy = y - 19.5, dz = z - 19.5;
        const double far = std::sqrt(dx * dx + dy * dy + dz * dz);
        const double wave = height * std::sin(waves * dx) * std::cos(waves * dy + dz * waves);
        const double value = 128 + 12 * (radius + wave - far);
        samples.push_back(static_cast<char>(
            static_cast<unsigned char>(std::clamp(std::round(value), 0.0, 255.0))));
      }
  return samples;
}

std::string hash_text(const std::string& bytes) {
  return to_hex(hash_bytes(std::as_bytes(std::span(bytes))));
}

}  // namespace

const std::vector<std::string> variants = {
    "[surface]\nisovalue = 128\n[simplify]\ntolerance = 0.1\n",
    "[surface]\nisovalue = 100\n[simplify]\ntolerance = 0.1\n",
    "[surface]\nisovalue = 128\n[simplify]\ntolerance = 0.4\n",
    "[surface]\nisovalue = 128\ninside = \"below\"\n",
    "[surface]\nisovalue = 128\nborder = \"open\"\ninside = \"below\"\n",
    "[surface]\nisovalue = 128\n[[edit]]\nop = \"subtract\"\nshape = \"box\"\n"
    "center = [19, 19, 19]\nsize = [8, 9, 60]\n",
};

OutputTree tree_of(const fs::path& output) {
  OutputTree tree;
  if (!fs::is_directory(output)) return tree;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), output).string();
    if (name.find(".tmp-") != std::string::npos) continue;  // of runs that were killed
    const std::string bytes = bytes_of_file(entry.path());
    if (name == "manifest.json")
      tree["manifest"] = manifest_essence(bytes);
    else
      tree[name] = hash_text(bytes);
  }
  return tree;
}

std::string tree_difference(const OutputTree& expected, const OutputTree& found) {
  std::string text;
  for (const auto& [name, hash] : expected) {
    const auto other = found.find(name);
    if (other == found.end())
      text += name + " is missing; ";
    else if (other->second != hash)
      text += name + " differs; ";
  }
  for (const auto& [name, hash] : found)
    if (!expected.contains(name)) text += name + " is too much; ";
  return text;
}

void clear_queue(const Surroundings& surroundings) {
  if (!surroundings.cluster) return;
  const std::string command =
      "scancel --user=\"$(id -un)\"; until queue=$(squeue -h) && [ -z \"$queue\" ]; do sleep 0.2; "
      "done";
  const ProcessEnd end =
      run_watched({"/bin/sh", "-c", command}, surroundings.root, surroundings.root / "queue", {20});
  if (end.timed_out) throw std::runtime_error("the cluster's queue does not get empty: " + end.err);
}

CleanRuns::CleanRuns(const fs::path& program, const fs::path& folder)
    : program_(program), folder_(folder) {}

void CleanRuns::begin(InputKind kind) {
  kind_ = kind;
  contents_.clear();
  numbers_.clear();
  trees_.clear();
}

std::string CleanRuns::input_name() const {
  return kind_ == InputKind::raw ? "v.raw" : "v.nrrd";
}

Content CleanRuns::known(const std::string& bytes) {
  const auto [found, added] = numbers_.emplace(bytes, static_cast<Content>(contents_.size()));
  if (added) contents_.push_back(bytes);
  return found->second;
}

Content CleanRuns::made(Random& random) {
  const double radius = 10 + static_cast<double>(pick(random, 7));
  const std::string samples = ball_samples(radius, 0.2 + 0.1 * static_cast<double>(pick(random, 4)),
                                           static_cast<double>(pick(random, 3)));
  if (kind_ == InputKind::raw) return known(samples);
  const bool gzip = kind_ == InputKind::nrrd_gzip;
  std::string file = fmt::format(
      "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\nspacings: 1 1 1\nencoding: {1}\n\n",
      side, gzip ? "gzip" : "raw");
  if (gzip) {
    const auto packed = deflated(std::as_bytes(std::span(samples)), Wrapper::gzip);
    file.append(reinterpret_cast<const char*>(packed.data()), packed.size());
  } else {
    file += samples;
  }
  return known(file);
}

std::string CleanRuns::config_text(std::size_t variant, const std::string& output,
                                   const std::string& work) const {
  const std::string layout =
      kind_ == InputKind::raw
          ? fmt::format("format = \"raw\"\ntype = \"uint8\"\nsize = [{0}, {0}, {0}]\n", side)
          : "";
  return fmt::format(
      "[input]\npath = \"{}\"\n{}[output]\ndirectory = \"{}\"\ntile_vertices = 1024\n[work]\n"
      "directory = \"{}\"\nbrick = 16\nshard = 1\nchunk = 16\n[run]\nthreads = 2\n{}",
      input_name(), layout, output, work, variants[variant]);
}

const std::optional<OutputTree>& CleanRuns::tree(Content content, std::size_t variant) {
  const auto [found, added] = trees_.try_emplace({content, variant});
  if (!added || content == no_content) return found->second;
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  write_bytes(folder_ / input_name(), bytes(content));
  write_bytes(folder_ / "clean.toml", config_text(variant, "clean.mesh", "clean.work"));
  const ProcessEnd run =
      run_watched({program_.string(), "run", "clean.toml"}, folder_, folder_ / "run", {60});
  if (run.exit_code != 0) return found->second;
  const ProcessEnd verified =
      run_watched({program_.string(), "verify", "clean.mesh"}, folder_, folder_ / "verify", {60});
  if (verified.exit_code != 0)
    throw std::runtime_error("verify refuses a clean run: " + verified.out + verified.err);
  found->second = tree_of(folder_ / "clean.mesh");
  return found->second;
}

}  // namespace voxweld::testing
