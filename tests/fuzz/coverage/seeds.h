// Sound inputs of the entries: the specimens (tests/fuzz/specimens.h), and some more.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace voxweld::testing {

struct Seed {
  std::string entry;  // its name
  std::string name;   // of the specimen
  std::string bytes;
};

// Made below `scratch`, which is left as it is then. program: voxweld, for what it alone can make;
// empty: without that.
std::vector<Seed> make_seeds(const std::filesystem::path& program,
                             const std::filesystem::path& scratch);

}  // namespace voxweld::testing
