// The output directory, for as long as a run writes it.
#pragma once

#include "pipeline/stage/context.h"
#include "storage/support/directory_lock.h"

namespace voxweld {

class OutputClaim {
 public:
  // Waits where another process runs the same config. InputError where one of another config writes
  // the directory or has written it (but for context.force). context: has the lock while this
  // lives.
  explicit OutputClaim(RunContext& context);
  ~OutputClaim() { context_.lock = nullptr; }
  OutputClaim(const OutputClaim&) = delete;
  OutputClaim& operator=(const OutputClaim&) = delete;

 private:
  RunContext& context_;
  DirectoryLock lock_;
};

// Throws where OutputClaim would, but takes and changes nothing.
void check_claim(const RunContext& context);

}  // namespace voxweld
