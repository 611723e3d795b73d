// Files written, and read, by other people's programs: a script in Python, run by the test.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "storage/support/file_io.h"
#include "tests/support/python_script.h"

namespace voxweld::testing {

// Runs the script in the folder. Its output is shown where it fails.
inline void run_python(const std::string& python, const std::filesystem::path& folder,
                       const std::string& script) {
  write_whole_file(folder / "script.py", as_bytes(script), Durability::rename_only);
  const std::string command =
      "cd '" + folder.string() + "' && " + python + " script.py >script.out 2>&1";
  if (std::system(command.c_str()) != 0)
    throw std::runtime_error("the script failed: " + read_text_file(folder / "script.out"));
}

}  // namespace voxweld::testing
