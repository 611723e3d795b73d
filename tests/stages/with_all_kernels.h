// Runs a test with each vector unit's kernels in turn.
#pragma once

#include <gtest/gtest.h>

#include <string_view>

#include "stages/contouring/qef.h"

namespace voxweld::testing {

// The kernels that this processor has; those from before are chosen again at the end.
template <class F>
void with_all_kernels(const F& f) {
  const std::string_view before = qef_kernels().name;
  for (const char* name : {"base", "avx2", "avx512"}) {
    if (!choose_qef_kernels(name)) continue;
    SCOPED_TRACE(name);
    f();
  }
  choose_qef_kernels(before);
}

}  // namespace voxweld::testing
