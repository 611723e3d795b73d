// What a stage tells the user while it runs and when it is done.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "pipeline/executor/console.h"
#include "pipeline/executor/resources.h"

namespace voxweld {

struct ProgressSettings {
  bool enabled = true;           // false: not a word, the summary included
  double bar_interval_s = 0.1;   // between two drawings of the bar
  double line_interval_s = 5;    // between two plain lines, where there is no terminal
  bool redraw_by_itself = true;  // a thread keeps times going while long units run
  std::function<double()> now;   // seconds, never decreasing; empty: the system's clock
};

// What is about to run.
struct StageStart {
  std::string stage;         // "build"
  std::string noun;          // of the units, in the plural: "shards"
  std::uint64_t units = 0;   // to be done
  double weight = 0;         // sum of their weights; 0: each counts the same
  std::uint64_t reused = 0;  // units found done, beside `units`
  // One of the units that is none of the others' kind, such as "merged mesh": named, not counted
  // among them. Empty: there is none.
  std::string apart = {};
};

// "1 shard", "2 shards", "1 mesh", "1 vertex": the noun is given in the plural.
std::string counted(std::uint64_t count, const std::string& plural);

// Progress of one stage. On a terminal a bar with rate and time left, redrawn in place; elsewhere
// plain lines, at most one in line_interval_s beside those of the begin and the end. Thread-safe.
class StageProgress {
 public:
  StageProgress(std::shared_ptr<Console> console, ProgressSettings settings, StageStart start);
  // Without finish() (the stage failed) the bar is taken away and no summary is given.
  ~StageProgress();
  StageProgress(const StageProgress&) = delete;
  StageProgress& operator=(const StageProgress&) = delete;

  // apart: it was the one that is apart.
  void unit_done(double weight, bool apart = false);
  void add_bytes(std::uint64_t bytes);
  // Draws if the time for it has come.
  void refresh();
  // The summary line: "build    64 shards      1.2 s    3.4 GiB/s  peak 210.0 MiB". Call once,
  // when no worker runs any more.
  void finish(const StageFigures& figures);

 private:
  std::uint64_t counted_units() const { return start_.units - (start_.apart.empty() ? 0 : 1); }
  bool only_apart_left() const;
  double elapsed() const;
  std::string rate(double seconds) const;
  double fraction() const;
  std::string time_left() const;
  std::string bar() const;
  std::string plain_line() const;
  void stop_redrawing();

  const std::shared_ptr<Console> console_;
  const ProgressSettings settings_;
  const StageStart start_;
  const double begin_s_;
  std::atomic<std::uint64_t> units_done_{0};  // but for the one apart
  std::atomic<bool> apart_done_{false};
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<double> weight_done_{0};
  std::atomic<double> next_draw_s_;
  std::mutex draw_mutex_;
  std::mutex sleep_mutex_;
  std::condition_variable_any wake_;
  std::jthread redrawing_;
};

// "0.42 s", "12 s", "3 min 05 s", "2 h 07 min".
std::string readable_seconds(double seconds);

}  // namespace voxweld
