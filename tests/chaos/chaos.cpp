// Does at random what careless users do, and looks at what is left. See README.md.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "tests/chaos/episode.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t steps_an_episode = 25;

struct Options {
  fs::path program, keep;
  std::uint64_t steps = 10000, seed = 1;
  double seconds = 0;  // 0: as long as it takes
  std::int64_t only_episode = -1;
  bool cluster = false;
};

constexpr const char* usage =
    "usage: chaos PROGRAM [--steps N] [--seed S] [--seconds T] [--episode N] [--keep FOLDER] "
    "[--cluster]\n";

Options parse(int argc, char** argv) {
  Options options;
  if (argc < 2 || argv[1][0] == '-') throw std::invalid_argument(usage);
  options.program = fs::absolute(argv[1]);
  options.keep = fs::temp_directory_path() / "voxweld-chaos-failures";
  for (int i = 2; i < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--cluster") {
      options.cluster = true;
      --i;  // it has no value
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument(usage);
    const std::string value = argv[i + 1];
    if (name == "--steps")
      options.steps = std::stoull(value);
    else if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--seconds")
      options.seconds = std::stod(value);
    else if (name == "--episode")
      options.only_episode = std::stoll(value);
    else if (name == "--keep")
      options.keep = fs::absolute(value);
    else
      throw std::invalid_argument(usage);
  }
  return options;
}

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void keep(const Options& options, std::uint64_t number, const Episode& episode) {
  const fs::path kept = options.keep / fmt::format("seed{}-episode{}", options.seed, number);
  std::error_code ignored;
  fs::remove_all(kept, ignored);
  fs::create_directories(options.keep);
  fs::copy(episode.place(), kept, fs::copy_options::recursive | fs::copy_options::copy_symlinks,
           ignored);
  fs::create_directories(kept);
  write_bytes(kept / "chaos.txt", episode.log());
  const std::size_t wrong = episode.log().find("WRONG");
  fmt::print("episode {}: {}  kept in {}; again: --seed {} --episode {}\n", number,
             episode.log().substr(wrong), kept.string(), options.seed, number);
  std::fflush(stdout);
}

int run_chaos(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  std::string root = (fs::temp_directory_path() / "voxweld-chaos-XXXXXX").string();
  if (mkdtemp(root.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  const Surroundings surroundings{options.program, root, options.cluster};
  CleanRuns clean(options.program, fs::path(root) / "clean");
  Tally tally;
  const auto begin = Clock::now();
  const auto go_on = [&] {
    return tally.steps < options.steps && (options.seconds <= 0 || since(begin) < options.seconds);
  };
  for (std::uint64_t number = 0; go_on(); ++number) {
    if (options.only_episode >= 0 && number < static_cast<std::uint64_t>(options.only_episode))
      continue;
    Episode episode(surroundings, clean, options.seed * 1000003 + number, tally);
    for (std::uint64_t step = 0; step < steps_an_episode && go_on(); ++step)
      if (!episode.step()) {
        keep(options, number, episode);
        break;
      }
    if (options.only_episode >= 0) {
      fmt::print("{}", episode.log());
      break;
    }
  }
  clear_queue(surroundings);
  std::error_code ignored;
  fs::remove_all(root, ignored);
  fmt::print(
      "{} steps, {} commands in {:.0f} s with seed {}: {} done, {} refused ({} since the "
      "input changed), {} killed; {} outputs compared, {} failures\n",
      tally.steps, tally.commands, since(begin), options.seed, tally.done, tally.refused,
      tally.changed_under_way, tally.killed, tally.trees, tally.failures.size());
  if (options.cluster) fmt::print("  {:5} commands on the cluster\n", tally.on_cluster);
  for (const auto& [kind, count] : tally.kinds) fmt::print("  {:5} x {}\n", count, kind);
  return tally.failures.empty() ? 0 : 1;
}

}  // namespace
}  // namespace voxweld::testing

int main(int argc, char** argv) try {
  return voxweld::testing::run_chaos(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
