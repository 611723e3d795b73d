// The manual page, voxweld(1).
#pragma once

#include <string>

#include "pipeline/cli/command_text.h"

namespace voxweld {

// In roff, with the man macros: every command and option, every key of the config. `all` is the
// whole program.
std::string manual_page(const CommandText& all);

}  // namespace voxweld
