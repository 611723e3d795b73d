// The machine this process runs on.
#pragma once

#include <string>

namespace voxweld {

// Its name, as `hostname` says it; "unknown" where it has none.
std::string host_name();

}  // namespace voxweld
