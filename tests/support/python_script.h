// Files that others' writers make: scripts in Python, run when the test runs.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace voxweld::testing {

inline std::string quoted(const std::string& word) {
  std::string text("'");  // none of ours has a quote in it
  text.append(word).append("'");
  return text;
}

// A Python that has these modules ("h5py, numcodecs"): the one on the path, or the system's own.
inline std::optional<std::string> python_with(const std::string& modules) {
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    const std::string command =
        std::string(python) + " -c " + quoted("import " + modules) + " >/dev/null 2>&1";
    if (std::system(command.c_str()) == 0) return python;
  }
  return {};
}

// Runs the script of the source tree with these words.
inline void run_script(const std::string& python, const std::string& script,
                       const std::vector<std::string>& words) {
  std::string command = python + " " + quoted(script);
  for (const std::string& word : words) command.append(" ").append(quoted(word));
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

}  // namespace voxweld::testing

#define VOXWELD_NEEDS_PYTHON(modules)            \
  if (!::voxweld::testing::python_with(modules)) \
  GTEST_SKIP() << "needs python3 with the modules " modules
