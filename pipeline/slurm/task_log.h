// What a task that was killed, or never came so far as to report, has left behind of why.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace voxweld {

// The last error of the log, be it the program's, Slurm's or the shell's, else its last line; where
// it says nothing and the disk is full, that.
std::string last_words(const std::filesystem::path& log);
// Whether a task that says this ended for want of memory.
bool is_of_memory(std::string_view words);

}  // namespace voxweld
