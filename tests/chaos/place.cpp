#include "tests/chaos/place.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <span>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

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

std::string hash_text(const std::string& bytes) {
  return to_hex(hash_bytes(std::as_bytes(std::span(bytes))));
}

}  // namespace

OutputTree tree_of(const fs::path& output) {
  OutputTree tree;
  if (!fs::is_directory(output)) return tree;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), output).string();
    if (name.find(".tmp-") != std::string::npos) continue;  // of runs that were killed
    if (name == "report.html") continue;                    // it has times in it
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

Content CleanRuns::known(const std::string& bytes) {
  const auto [found, added] = numbers_.emplace(bytes, static_cast<Content>(contents_.size()));
  if (added) contents_.push_back(bytes);
  return found->second;
}

void CleanRuns::write_others(const fs::path& folder) const {
  for (const auto& [name, bytes] : files_of(kind_).others) write_bytes(folder / name, bytes);
}

Content CleanRuns::made(Random& random) {
  return known(random_input(kind_, random));
}

std::string CleanRuns::config_text(std::size_t variant, const std::string& output,
                                   const std::string& work) const {
  const Variant& own = variants_of(kind_)[variant];
  return fmt::format(
      "[input]\npath = \"{}\"\n{}[output]\ndirectory = \"{}\"\ntile_vertices = 1024\n[work]\n"
      "directory = \"{}\"\nbrick = 16\nshard = 1\nchunk = 16\n[run]\nthreads = 2\n{}",
      files_of(kind_).path, own.input, output, work, own.tables);
}

const std::optional<OutputTree>& CleanRuns::tree(Content content, std::size_t variant) {
  const auto [found, added] = trees_.try_emplace({content, variant});
  if (!added || content == no_content) return found->second;
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  write_others(folder_);
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
