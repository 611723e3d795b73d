// Gives every parser its sound inputs, which it has to accept, and each kept find, which it may
// accept or refuse; and, where that is asked for, sound inputs changed at random.
// Usage: replay_finds FINDS PROGRAM [--mutate N] [--seed S] [--only ENTRY] [--keep FOLDER]
//   FINDS: a folder of folders named like the entries; PROGRAM: voxweld
//   --only: changed are those of this entry; --keep: where those that fail are left
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <set>
#include <stdexcept>

#include "storage/support/error.h"
#include "tests/fuzz/coverage/entries.h"
#include "tests/fuzz/coverage/seeds.h"
#include "tests/fuzz/mutation.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* usage =
    "usage: replay_finds FINDS PROGRAM [--mutate N] [--seed S] [--only ENTRY] [--keep FOLDER]";

class Replay {
 public:
  explicit Replay(const fs::path& program) : modules_(program.parent_path()) {}

  // Whether it went well.
  bool give(const std::string& entry_name, const std::string& name, const std::string& bytes,
            bool sound) {
    const ParserEntry* entry = parser_named(entry_name);
    if (entry == nullptr) return complain(entry_name, name, "there is no such entry");
    if (!entry->module.empty() &&
        !fs::exists(modules_ / fmt::format("libvoxweld_{}.so", entry->module)))
      return true;
    seen_.insert(entry_name);
    ++given_;
    try {
      const FeedEnd end = feed(*entry, std::as_bytes(std::span(bytes)), limits());
      ++(end == FeedEnd::accepted ? accepted_ : refused_);
      if (!sound || end == FeedEnd::accepted) return true;
      return complain(entry_name, name, "a sound input is refused");
    } catch (const std::exception& error) {
      return complain(entry_name, name, error.what());
    }
  }

  // Whether all was well.
  bool end() const {
    for (const char* needed : {"nrrd", "zarr", "vti", "config", "ply", "container", "glb", "vtp"})
      if (!seen_.contains(needed)) {
        fmt::print("nothing was given to {}\n", needed);
        return false;
      }
    fmt::print("{} inputs to {} parsers: {} accepted, {} refused, {} complaints\n", given_,
               seen_.size(), accepted_, refused_, complaints_);
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

  bool complain(const std::string& entry, const std::string& name, const std::string& text) {
    ++complaints_;
    fmt::print("{} {}: {}\n", entry, name, text);
    std::fflush(stdout);
    return false;
  }

  fs::path modules_;
  std::set<std::string> seen_;
  std::size_t given_ = 0, accepted_ = 0, refused_ = 0, complaints_ = 0;
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

struct Options {
  fs::path finds, program;
  std::uint64_t mutations = 0, seed = 1;
  std::string only;  // entry
  fs::path keep = fs::temp_directory_path() / "voxweld-parser-finds";
};

// Seeds changed at random, each entry as often as the others. What is under way lies in `keep`, so
// that a crash leaves it there.
void mutate(Replay& replay, const std::vector<Seed>& seeds, const Options& options) {
  std::map<std::string, std::vector<std::string>> by_entry;
  for (const Seed& seed : seeds)
    if (options.only.empty() || seed.entry == options.only)
      by_entry[seed.entry].push_back(seed.bytes);
  if (by_entry.empty()) throw std::runtime_error("no seeds of that entry");
  fs::create_directories(options.keep);
  Random random(options.seed);
  auto next = by_entry.begin();
  for (std::uint64_t i = 0; i < options.mutations; ++i) {
    const auto& [entry, of_entry] = *next;
    std::string bytes = pick_from(random, of_entry);
    const std::string other = pick_from(random, of_entry);
    for (std::size_t times = 1 + pick(random, 3); times > 0; --times)
      mutate_bytes(bytes, other, random);
    const std::string name = fmt::format("{}-seed{}-{}", entry, options.seed, i);
    write_bytes(options.keep / name, bytes);
    if (replay.give(entry, name, bytes, false)) fs::remove(options.keep / name);
    if (++next == by_entry.end()) next = by_entry.begin();
  }
}

bool replay(const Options& options) {
  setenv("VOXWELD_MODULES", options.program.parent_path().c_str(), 0);
  const std::vector<Seed> seeds = make_seeds(options.program, case_folder() / "specimens");
  fs::remove_all(case_folder() / "specimens");
  limit_memory();
  Replay replay(options.program);
  for (const Seed& seed : seeds) replay.give(seed.entry, seed.name, seed.bytes, true);
  for (const fs::path& folder : sorted(options.finds))
    if (fs::is_directory(folder))
      for (const fs::path& file : sorted(folder))
        replay.give(folder.filename().string(), file.filename().string(), bytes_of_file(file),
                    false);
  if (options.mutations > 0) mutate(replay, seeds, options);
  return replay.end();
}

Options parse(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) throw std::invalid_argument(usage);
  Options options;
  options.finds = argv[1];
  options.program = fs::absolute(argv[2]);
  for (int i = 3; i < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--mutate")
      options.mutations = std::stoull(value);
    else if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--only")
      options.only = value;
    else if (name == "--keep")
      options.keep = fs::absolute(value);
    else
      throw std::invalid_argument(usage);
  }
  return options;
}

}  // namespace
}  // namespace voxweld::testing

int main(int argc, char** argv) try {
  return voxweld::testing::replay(voxweld::testing::parse(argc, argv)) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
