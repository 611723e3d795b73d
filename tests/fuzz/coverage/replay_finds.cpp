// Gives every parser its sound inputs, which it has to accept, and each kept find, which it may
// accept or refuse.
// Usage: replay_finds FINDS PROGRAM
//   FINDS: a folder of folders named like the entries; PROGRAM: voxweld
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <set>

#include "storage/support/error.h"
#include "tests/fuzz/coverage/entries.h"
#include "tests/fuzz/coverage/seeds.h"
#include "tests/fuzz/mutation.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

class Replay {
 public:
  explicit Replay(const fs::path& program) : modules_(program.parent_path()) {}

  void give(const std::string& entry_name, const std::string& name, const std::string& bytes,
            bool sound) {
    const ParserEntry* entry = parser_named(entry_name);
    if (entry == nullptr) return complain(entry_name, name, "there is no such entry");
    if (!entry->module.empty() &&
        !fs::exists(modules_ / fmt::format("libvoxweld_{}.so", entry->module)))
      return;
    seen_.insert(entry_name);
    ++given_;
    // A crash says nothing more.
    fmt::print("{} {}\n", entry_name, name);
    std::fflush(stdout);
    try {
      const FeedEnd end = feed(*entry, std::as_bytes(std::span(bytes)), limits());
      if (sound && end == FeedEnd::refused) complain(entry_name, name, "a sound input is refused");
    } catch (const std::exception& error) {
      complain(entry_name, name, error.what());
    }
  }

  // Whether all was well.
  bool end() const {
    for (const char* needed : {"nrrd", "zarr", "vti", "config", "ply", "container", "glb"})
      if (!seen_.contains(needed)) {
        fmt::print("nothing was given to {}\n", needed);
        return false;
      }
    fmt::print("{} inputs to {} parsers, {} complaints\n", given_, seen_.size(), complaints_);
    return complaints_ == 0;
  }

 private:
  // Sanitizers slow everything down.
  static FeedLimits limits() {
#ifdef __SANITIZE_ADDRESS__
    return {.seconds = 5};
#else
    return {.seconds = 1};
#endif
  }

  void complain(const std::string& entry, const std::string& name, const std::string& text) {
    ++complaints_;
    fmt::print("  {} {}: {}\n", entry, name, text);
  }

  fs::path modules_;
  std::set<std::string> seen_;
  std::size_t given_ = 0, complaints_ = 0;
};

// What a header may say is not to be allocated: with little more than the budget such a thing fails.
void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  const rlimit most{std::uint64_t{2} << 30, std::uint64_t{2} << 30};
  setrlimit(RLIMIT_AS, &most);
#endif
}

std::vector<fs::path> sorted(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

bool replay(const fs::path& finds, const fs::path& program) {
  setenv("VOXWELD_MODULES", program.parent_path().c_str(), 0);
  const std::vector<Seed> seeds = make_seeds(program, case_folder() / "specimens");
  fs::remove_all(case_folder() / "specimens");
  limit_memory();
  Replay replay(program);
  for (const Seed& seed : seeds) replay.give(seed.entry, seed.name, seed.bytes, true);
  for (const fs::path& folder : sorted(finds))
    for (const fs::path& file : sorted(folder))
      replay.give(folder.filename().string(), file.filename().string(), bytes_of_file(file), false);
  return replay.end();
}

}  // namespace
}  // namespace voxweld::testing

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: replay_finds FINDS PROGRAM\n");
    return 2;
  }
  return voxweld::testing::replay(argv[1], std::filesystem::absolute(argv[2])) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
