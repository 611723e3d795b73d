// A folder with a small volume in it, and what the commands make of it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/pipeline/run/program.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

class Workplace {
 public:
  // Absolute path of a name in the folder.
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string phantom(const std::string& name, int size = 24) const;
  // Runs the program and expects that it is content.
  ProgramResult run(const std::vector<std::string>& arguments) const;
  // phantom, init, run; returns nothing: work in scene.work, output in scene.mesh.
  void run_scene(const std::vector<std::string>& settings) const;
  nlohmann::json info(const std::string& path, std::vector<std::string> more = {}) const;

 private:
  TempDirectory folder_;
};

// The program fails as for the user's mistakes, with one message that holds all of these.
void expect_refused(const std::vector<std::string>& arguments,
                    const std::vector<std::string>& message);

void write_bytes(const std::string& path, const std::string& bytes);
std::string read_bytes(const std::string& path);

// Files below, by kind of name; the first of them.
std::string first_file(const std::string& folder, const std::string& ending);

}  // namespace voxweld::testing
