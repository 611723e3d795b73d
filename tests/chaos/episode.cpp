#include "tests/chaos/episode.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

void pause(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// A change of the input that was set going may still write there.
void remove_wholly(const fs::path& path) {
  std::error_code error;
  for (int i = 0; i < 100; ++i) {
    fs::remove_all(path, error);
    if (!error) return;
    pause(0.01);
  }
  throw fs::filesystem_error("cannot remove", path, error);
}

// Turned away before it wrote anything.
bool was_turned_away(const ProcessEnd& end) {
  return end.exit_code == 2 && (end.err.find("is writing it for") != std::string::npos ||
                                end.err.find("--force") != std::string::npos);
}

}  // namespace

Episode::Episode(const Surroundings& surroundings, CleanRuns& clean, std::uint64_t seed,
                 Tally& tally)
    : surroundings_(surroundings),
      program_(surroundings.program),
      root_(surroundings.root),
      place_(root_ / "place"),
      clean_(clean),
      random_(seed),
      tally_(tally),
      // The second shares its work with the first, the third its output.
      configs_{{"a.toml", "a.mesh", "a.work"},
               {"b.toml", "b.mesh", "a.work"},
               {"c.toml", "a.mesh", "c.work"}} {
  clear_queue(surroundings_);
  remove_wholly(root_ / "place");
  remove_wholly(root_ / "moved");
  fs::create_directories(place_);
  clean_.begin(static_cast<InputKind>(pick(random_, input_kinds)));
  clean_.write_others(place_);
  put_input(clean_.made(random_));
  for (const Config& config : configs_) write_config(config);
  outputs_["a.mesh"];
  outputs_["b.mesh"];
}

Episode::~Episode() {
  unmount_small();
}

bool Episode::step() {
  using Step = void (Episode::*)();
  static const std::vector<std::pair<const char*, Step>> steps = {
      {"run", &Episode::plain_step},
      {"run", &Episode::plain_step},
      {"change the input", &Episode::change_step},
      {"change the input", &Episode::change_step},
      {"change it while it is read", &Episode::change_under_way_step},
      {"change it while it is read", &Episode::change_under_way_step},
      {"change it while it is read", &Episode::change_under_way_step},
      {"kill or interrupt", &Episode::stop_step},
      {"kill or interrupt", &Episode::stop_step},
      {"runs at once", &Episode::together_step},
      {"runs at once", &Episode::together_step},
      {"change a config", &Episode::config_step},
      {"move the work", &Episode::work_step},
      {"damage a file", &Episode::damage_step},
      {"single stages", &Episode::stage_step},
      {"fill the disk", &Episode::full_disk_step},
      {"write-protect", &Episode::read_only_step},
      {"move all", &Episode::move_step}};
  const auto& [kind, act] = pick_from(random_, steps);
  ++tally_.steps;
  ++tally_.kinds[kind];
  say(fmt::format("- {}", kind));
  // Without an input there is little to be seen.
  if (!fs::is_regular_file(input()) && pick(random_, 3) == 0) say("    " + change_input());
  (this->*act)();
  for (auto& [name, output] : outputs_) check_output(name, output);
  return !failed_;
}

void Episode::wrong(const std::string& what) {
  failed_ = true;
  say("WRONG: " + what);
  tally_.failures.push_back(what);
}

void Episode::write_config(const Config& config) const {
  write_bytes(place_ / config.name, clean_.config_text(config.variant, config.output, config.work));
}

Content Episode::input_now() {
  if (!fs::is_regular_file(input())) return no_content;
  return clean_.known(bytes_of_file(input()));
}

void Episode::put_input(Content content) {
  write_bytes(root_ / "new", clean_.bytes(content));
  fs::rename(root_ / "new", input());
}

Episode::Run Episode::random_run(std::size_t config) {
  Run run;
  run.config = config;
  run.variant = configs_[config].variant;
  // Never in the result.
  const auto set = [&](const char* setting) {
    run.words.insert(run.words.end(), {"--set", setting});
  };
  if (pick(random_, 3) == 0) set(pick(random_, 2) == 0 ? "work.copy=true" : "work.copy=false");
  if (pick(random_, 4) == 0) set("work.brick=32");
  if (pick(random_, 4) == 0) set("work.shard=2");
  if (pick(random_, 4) == 0) set("run.threads=1");
  if (pick(random_, 6) == 0) run.words.push_back("--force");
  // A disk that is mounted here is not mounted on the nodes.
  if (surroundings_.cluster && !mounted_ && pick(random_, 3) == 0) send_to_cluster(run);
  return run;
}

void Episode::send_to_cluster(Run& run) {
  run.on_cluster = true;
  for (const std::string& setting :
       {std::string("run.executor=slurm"), std::string("run.memory=400MiB"),
        std::string("slurm.cpus_per_task=1"),
        fmt::format("slurm.shards_per_task={}", 6 + pick(random_, 12))})
    run.words.insert(run.words.end(), {"--set", setting});
}

double Episode::random_moment(const Run& run) {
  const double slice_s = run.on_cluster ? 0.1 : 0.002;  // an array's tasks take seconds to start
  return slice_s * static_cast<double>(pick(random_, 60));
}

void Episode::run_together(std::vector<Run> runs, const std::function<void()>& meanwhile) {
  in_force_ = {input_now()};
  std::vector<WatchedProcess> processes;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::vector<std::string> command = {program_.string(), runs[i].command,
                                        configs_[runs[i].config].name};
    command.insert(command.end(), runs[i].words.begin(), runs[i].words.end());
    std::string told;
    for (const auto& [name, value] : runs[i].variables)
      told += fmt::format("{}={:?} ", name, value);
    say(fmt::format("    {}{}{}", told, shell_text(command),
                    runs[i].signal == 0 ? ""
                                        : fmt::format("  # signal {} after {} s", runs[i].signal,
                                                      runs[i].after_s)));
    tally_.on_cluster += runs[i].on_cluster ? 1 : 0;
    processes.emplace_back(command, place_, root_ / fmt::format("said{}", i), runs[i].variables);
  }
  if (meanwhile) meanwhile();
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].signal != 0 && !processes[i].wait_for(runs[i].after_s))
      processes[i].send(runs[i].signal);
  std::vector<ProcessEnd> ends;
  ends.reserve(processes.size());
  const bool on_cluster =
      std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.on_cluster; });
  for (WatchedProcess& process : processes) ends.push_back(process.wait({on_cluster ? 120.0 : 60}));
  in_force_.insert(input_now());
  judge(runs, ends);
}

void Episode::judge(const std::vector<Run>& runs, const std::vector<ProcessEnd>& ends) {
  // By output directory: what ended well, and whether anything else may have written.
  std::map<std::string, std::vector<Origin>> good;
  std::map<std::string, bool> broken;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i];
    const ProcessEnd& end = ends[i];
    ++tally_.commands;
    ++(end.signal != 0 ? tally_.killed : end.exit_code == 0 ? tally_.done : tally_.refused);
    const bool changed = end.err.find("changed while") != std::string::npos;
    tally_.changed_under_way += changed ? 1 : 0;
    say(fmt::format("      exit {}, signal {}: {}", end.exit_code, end.signal, end.err));
    const std::string complaint = run.may_die && end.signal != 0 ? "" : complaint_of(end, false);
    if (!complaint.empty())
      wrong(fmt::format("{}: {}", complaint, end.err.substr(0, end.err.find('\n'))));
    Output& output = outputs_[configs_[run.config].output];
    for (const Content content : in_force_)
      if (content != no_content) output.history.emplace_back(content, run.variant);
    if (run.command != "run") continue;
    const std::string& name = configs_[run.config].output;
    if (end.exit_code == 0)
      for (const Content content : in_force_) good[name].emplace_back(content, run.variant);
    else if (!was_turned_away(end))
      broken[name] = true;
  }
  for (const Run& run : runs) {
    const std::string& name = configs_[run.config].output;
    if (broken[name])
      outputs_[name].expected.clear();
    else if (!good[name].empty())
      outputs_[name].expected = good[name];
  }
}

void Episode::check_output(const std::string& name, Output& output) {
  const fs::path folder = place_ / name;
  OutputTree found = tree_of(folder);
  if (!output.expected.empty()) {
    ++tally_.trees;
    std::string difference;
    for (const auto& [content, variant] : output.expected) {
      const auto& tree = clean_.tree(content, variant);
      if (tree && *tree == found) return;
      difference += fmt::format("[input {}, config {}] {} ", content, variant,
                                tree ? tree_difference(*tree, found) : "is refused");
    }
    return wrong(fmt::format("{} after exit code 0 is of no clean run: {}", name, difference));
  }
  // The last command failed. What still looks like a result must be one. One that was killed leaves
  // its lock, and at its very end its note, until the next run.
  found.erase("voxweld.lock");
  found.erase("unfinished.files");
  if (!found.contains("manifest")) return;
  ++tally_.trees;
  for (auto origin = output.history.rbegin(); origin != output.history.rend(); ++origin) {
    const auto& tree = clean_.tree(origin->first, origin->second);
    if (tree && *tree == found) return;
  }
  const ProcessEnd verified =
      run_watched({program_.string(), "verify", name}, place_, root_ / "verify", {60});
  if (verified.exit_code == 0)
    wrong(fmt::format("{} verifies and is of no clean run, after a command that failed", name));
}

std::string Episode::random_file(const std::string& folder) {
  std::vector<std::string> files;
  if (fs::is_directory(place_ / folder))
    for (const auto& entry : fs::recursive_directory_iterator(place_ / folder))
      if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), place_).string());
  std::sort(files.begin(), files.end());
  return files.empty() ? "" : pick_from(random_, files);
}

// Runs of what is there, in its order.
void Episode::plain_step() {
  run_together({random_run(pick(random_, configs_.size()))});
}

void Episode::stop_step() {
  Run run = random_run(pick(random_, configs_.size()));
  run.may_die = true;
  const std::vector<int> signals = {SIGKILL, SIGKILL, SIGINT, SIGTERM};
  const int signal = pick_from(random_, signals);
  if (pick(random_, 2) == 0) {
    run.signal = signal;
    run.after_s = random_moment(run);
  } else {
    const std::vector<std::string> with = {
        "rename /place/a.work", "rename /place/a.mesh", ".octree", ".tile", ".drc", "removal",
        "manifest.json"};
    run.variables = {{"LD_PRELOAD", program_.parent_path() / "commit_points.so"},
                     {"VOXWELD_POINTS_BELOW", root_.string()},
                     {"VOXWELD_POINTS_WITH", pick_from(random_, with)},
                     {"VOXWELD_POINTS_NTH", std::to_string(1 + pick(random_, 8))},
                     {"VOXWELD_POINTS_DO", fmt::format("kill -{} $PPID", signal)}};
  }
  run_together({run});
  if (pick(random_, 2) == 0) run_together({random_run(run.config)});
}

void Episode::together_step() {
  std::vector<Run> runs;
  const std::size_t count = 2 + pick(random_, 2), first = pick(random_, configs_.size());
  const bool same = pick(random_, 2) == 0;
  for (std::size_t i = 0; i < count; ++i)
    runs.push_back(random_run(same ? first : pick(random_, configs_.size())));
  if (pick(random_, 4) == 0) {
    runs.front().signal = SIGKILL;
    runs.front().after_s = random_moment(runs.front());
    runs.front().may_die = true;
  }
  run_together(runs);
}

void Episode::change_under_way_step() {
  Run run = random_run(pick(random_, configs_.size()));
  if (pick(random_, 2) == 0) {  // all is made anew, so all is read
    fs::remove_all(place_ / configs_[run.config].work);
    say("    without earlier work");
  }
  if (pick(random_, 3) == 0) {
    const double after_s = random_moment(run);
    run_together({run}, [&] {
      pause(after_s);
      say("    after " + std::to_string(after_s) + " s: " + change_input());
      in_force_.insert(input_now());
    });
    return;
  }
  const std::vector<std::string> with = {
      "after rename /place/a.work", ".octree", ".octree", ".tile", "rename", ".drc", "manifest"};
  run.variables = {{"LD_PRELOAD", program_.parent_path() / "commit_points.so"},
                   {"VOXWELD_POINTS_BELOW", root_.string()},
                   {"VOXWELD_POINTS_WITH", pick_from(random_, with)},
                   {"VOXWELD_POINTS_NTH", std::to_string(1 + pick(random_, 10))},
                   {"VOXWELD_POINTS_DO", input_change_command()}};
  run_together({run});
}

}  // namespace voxweld::testing
