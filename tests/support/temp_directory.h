// A directory that goes with the test, and the folder of real scans where there is one.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace voxweld::testing {

class TempDirectory {
 public:
  TempDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "voxweld-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = name;
  }
  ~TempDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDirectory(const TempDirectory&) = delete;
  TempDirectory& operator=(const TempDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// Below the folder of real scans, which need not be there.
std::filesystem::path shared_data(const std::string& name);
// The program that was built beside the tests.
std::filesystem::path program_path();

}  // namespace voxweld::testing

// Skips the test, naming what is missing, where the real scans are not at hand.
#define VOXWELD_NEEDS_SHARED_DATA(name)                                \
  if (!std::filesystem::exists(::voxweld::testing::shared_data(name))) \
  GTEST_SKIP() << "needs " << ::voxweld::testing::shared_data(name).string()
