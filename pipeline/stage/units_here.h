// Work that a process does itself though the units of its stages run elsewhere.
#pragma once

#include "pipeline/stage/context.h"

namespace voxweld {

// While it lives, units run in this process, whatever the context's executor is.
class UnitsHere {
 public:
  explicit UnitsHere(RunContext& context) : context_(context), before_(context.executor) {
    if (before_ == nullptr || !before_->in_process()) context_.executor = &here_;
  }
  ~UnitsHere() { context_.executor = before_; }
  UnitsHere(const UnitsHere&) = delete;
  UnitsHere& operator=(const UnitsHere&) = delete;

 private:
  RunContext& context_;
  Executor* before_;
  LocalExecutor here_;
};

}  // namespace voxweld
