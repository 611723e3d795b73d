// Usage: write_seeds FOLDER [PROGRAM]: FOLDER/ENTRY/NAME for each sound input. PROGRAM is voxweld.
#include <cstdio>
#include <exception>

#include "tests/fuzz/coverage/seeds.h"
#include "tests/fuzz/mutation.h"

int main(int argc, char** argv) try {
  namespace fs = std::filesystem;
  if (argc < 2) {
    std::fprintf(stderr, "usage: write_seeds FOLDER [PROGRAM]\n");
    return 2;
  }
  const fs::path folder = fs::absolute(argv[1]), scratch = folder / ".specimens";
  fs::remove_all(scratch);
  const fs::path program = argc > 2 ? fs::absolute(argv[2]) : fs::path();
  for (const auto& seed : voxweld::testing::make_seeds(program, scratch)) {
    fs::create_directories(folder / seed.entry);
    voxweld::testing::write_bytes(folder / seed.entry / seed.name, seed.bytes);
  }
  fs::remove_all(scratch);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
