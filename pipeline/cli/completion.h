// Completion of the command line in shells.
#pragma once

#include <string>

#include "pipeline/cli/command_text.h"

namespace voxweld {

// A script for the shell to source: commands, options and the words they take, files where an
// option takes one, keys of the config after --set. `all` is the whole program.
std::string bash_completion(const CommandText& all);
std::string zsh_completion(const CommandText& all);
std::string fish_completion(const CommandText& all);

}  // namespace voxweld
