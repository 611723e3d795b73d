// A folder of a work directory, for as long as a run writes and reads what several runs share in it.
#pragma once

#include <filesystem>

#include "pipeline/stage/context.h"
#include "storage/support/directory_lock.h"

namespace voxweld {

// Configs that differ in their edits, or in what comes after build, have their shards in one
// folder. Of two runs at once one would read what the other has just replaced. What filters need
// before is of all tasks of a stage, and each of them may come upon it first.
class WorkClaim {
 public:
  // Waits where another process has the folder: it will find done what that one leaves. Between
  // DirectoryLock's looks it throws where context is interrupted.
  WorkClaim(const RunContext& context, const std::filesystem::path& folder);

  // Throws StorageError where somebody else has taken it over.
  void check() const { lock_.check(); }

 private:
  DirectoryLock lock_;
};

}  // namespace voxweld
