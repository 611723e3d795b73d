// A few dozen careless steps in one folder, checked after each.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/chaos/place.h"

namespace voxweld::testing {

struct Tally {
  std::map<std::string, std::uint64_t> kinds;  // of steps
  std::uint64_t steps = 0, commands = 0, done = 0, refused = 0, killed = 0;
  std::uint64_t changed_under_way = 0;  // refused since the input changed
  std::uint64_t on_cluster = 0;         // commands whose work went there
  std::uint64_t trees = 0;              // outputs compared with clean runs
  std::vector<std::string> failures;
};

class Episode {
 public:
  Episode(const Surroundings& surroundings, CleanRuns& clean, std::uint64_t seed, Tally& tally);
  ~Episode();
  Episode(const Episode&) = delete;
  Episode& operator=(const Episode&) = delete;

  // One step, chosen at random. False when something was wrong: then log() tells the story.
  bool step();
  const std::string& log() const { return log_; }
  const std::filesystem::path& place() const { return place_; }

 private:
  struct Config {
    std::string name, output, work;
    std::size_t variant = 0;
  };
  // An input and a variant whose clean run the output may be.
  using Origin = std::pair<Content, std::size_t>;
  struct Output {
    std::vector<Origin> expected;  // one of these, if not empty
    std::vector<Origin> history;   // all that ever were in force, the newest last
  };
  struct Run {
    std::size_t config = 0;
    std::vector<std::string> words;  // behind the config
    std::string command = "run";
    Variables variables;
    int signal = 0;
    double after_s = 0;
    std::size_t variant = 0;  // when it began
    bool may_die = false;     // a signal is sent, from here or from within
    bool on_cluster = false;
  };

  Run random_run(std::size_t config);
  void send_to_cluster(Run& run);
  double random_moment(const Run& run);  // in seconds from its start, while it may be under way
  void run_together(std::vector<Run> runs, const std::function<void()>& meanwhile = {});
  void judge(const std::vector<Run>& runs, const std::vector<ProcessEnd>& ends);
  void check_output(const std::string& name, Output& output);
  void wrong(const std::string& what);
  void say(const std::string& what) { log_ += what + "\n"; }

  std::filesystem::path input() const { return place_ / clean_.input_name(); }
  Content input_now();
  void put_input(Content content);     // a new file in the place of the old
  std::string change_input();          // in one of many ways
  std::string input_change_command();  // the same as a shell command, for within a run
  void write_config(const Config& config) const;
  std::string random_file(const std::string& folder);

  void plain_step();
  void change_step();
  void change_under_way_step();
  void stop_step();
  void together_step();
  void config_step();
  void work_step();
  void damage_step();
  void stage_step();
  void on_small_disk(const std::string& size, const std::function<void()>& f);
  void run_and_check();
  void full_disk_step();
  void read_only_step();
  void move_step();
  bool mount_small(const std::string& size);
  void unmount_small();

  const Surroundings surroundings_;
  std::filesystem::path program_, root_, place_;
  CleanRuns& clean_;
  Random random_;
  Tally& tally_;
  std::vector<Config> configs_;
  std::map<std::string, Output> outputs_;
  std::set<Content> in_force_;
  bool mounted_ = false, failed_ = false;
  std::string log_;
};

}  // namespace voxweld::testing
