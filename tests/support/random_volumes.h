#pragma once

#include <cstdlib>

namespace voxweld::testing {

// How many random volumes a test tries, and of which seeds: from 0 on. For a longer look than the usual
// one, VOXWELD_VOLUMES says how many.
inline unsigned volumes_to_try(unsigned usual) {
  const char* wanted = std::getenv("VOXWELD_VOLUMES");
  return wanted == nullptr ? usual : static_cast<unsigned>(std::atoi(wanted));
}

}  // namespace voxweld::testing
