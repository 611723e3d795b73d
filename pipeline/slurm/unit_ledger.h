// The bookkeeping of a stage whose units run as tasks elsewhere: which unit is in which task, which
// is done, which has to be tried again, which is given up. Knows no Slurm and no clock of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/executor/error_set.h"
#include "pipeline/executor/executor.h"
#include "pipeline/slurm/array_folder.h"
#include "storage/manifest/task_report.h"

namespace voxweld {

// One task that was submitted and not yet settled.
struct Flight {
  std::int64_t job = 0, task = 0;
  ArrayFolder folder;
  std::vector<std::uint64_t> units;        // keys; those not known to be done
  std::optional<double> over_since = {};   // when it was first seen to have ended
  std::optional<double> stuck_since = {};  // when Slurm was first seen not to start it
};

// How a task ended, as far as anybody knows.
struct FlightEnd {
  std::optional<TaskReport> report;
  std::string slurm_state;      // empty: Slurm knows nothing of it any more
  std::string stuck = {};       // why Slurm would not start it; then it was cancelled
  std::string last_words = {};  // the end of its log, or what keeps it from writing one
};

class UnitLedger {
 public:
  // done: asks whether a unit's result is there; from several threads. retries: how often a unit is
  // tried again.
  UnitLedger(std::span<const Unit> units, std::function<bool(const Unit&)> done,
             std::int64_t retries);

  // Units of no task that may be tried at `now`, in key order.
  std::vector<Unit> ready(double now) const;
  bool open() const { return open_ > 0; }  // some unit is neither done nor given up

  // A task took off with those of the keys that are open and in no other task. False when there are
  // none: it is not watched then.
  bool take_off(Flight flight);
  std::vector<Flight>& flights() { return flights_; }

  // Looks for results of the flight, at most `most` of them, up to the first that is missing when
  // `in_order`, else several at once; returns the weights of those that turned out done.
  std::vector<double> look(Flight& flight, std::size_t& most, bool in_order);
  // The task has ended without the units it still has: tried again at a later time, or given up.
  void fail(const Flight& flight, const FlightEnd& end, double now);
  // Forgets the flights that have no units left.
  void sweep();

  // Of the units given up, in key order. Messages that differ in numbers only (a job, a node, a
  // file) are one, the first unit's with its log, so that a thousand units that fail alike make few
  // lines.
  std::vector<UnitError> errors() const;

 private:
  enum class State : std::uint8_t { waiting, flying, done, given_up };
  struct Entry {
    Unit unit;
    State state = State::waiting;
    std::int64_t failures = 0;
    double not_before = 0;
    UnitError error;
    std::string log;  // of the task that failed last
  };

  std::map<std::uint64_t, Entry> entries_;
  std::vector<Flight> flights_;
  std::function<bool(const Unit&)> done_;
  std::int64_t retries_;
  std::size_t open_;
};

}  // namespace voxweld
