// The errors of many units as one: gathered by unit key, never by arrival, so that one thread and
// many tell the same story.
#pragma once

#include <cstdint>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

#include "storage/support/error.h"

namespace voxweld {

struct UnitError {
  std::uint64_t key = 0;
  std::string unit;  // its name, for people
  std::string message;
  int exit_code = 1;         // 2: the user's to mend
  bool interrupted = false;  // the unit stopped because it was asked to
  std::string damaged_path;  // of a DamagedArtifact; else empty
  std::exception_ptr error;
};

// Several units failed. The message lists every failure, equal ones on one line. The exit code is
// 2 when all are the user's to mend, else 1.
class ErrorSet : public Error {
 public:
  // Precondition: `errors` is not empty and sorted by key.
  ErrorSet(const std::string& stage, std::vector<UnitError> errors);

  const std::vector<UnitError>& errors() const { return errors_; }
  bool interrupted() const;
  // Rebuilding damaged_paths() would mend every failure listed here.
  bool only_damaged() const;

 private:
  std::vector<UnitError> errors_;
};

// The artifacts that `error`, a DamagedArtifact or an ErrorSet, names as damaged: sorted, each
// once. Empty for any other error.
std::vector<std::string> damaged_paths(const std::exception& error);
// True when rebuilding damaged_paths(error) mends all of it.
bool is_only_damage(const std::exception& error);

// Gathers what the workers throw. Thread-safe.
class ErrorCollector {
 public:
  // Records the exception being handled. Precondition: called from a catch block. Returns true when
  // it is of no use to start other units: a stop was asked for, or the disk is full.
  bool record_current(std::uint64_t key, const std::string& unit);
  // Records that units were left out because a stop was asked for.
  void record_interrupt();

  // Returns when nothing was recorded; throws a single failure as it came and several as ErrorSet.
  // Interruptions count as one, told after the others. Call once, when no worker runs any more.
  void throw_if_any(const std::string& stage);

 private:
  std::mutex mutex_;
  std::vector<UnitError> errors_;
  bool interrupted_ = false;
};

}  // namespace voxweld
