// Changes files at random and has voxweld read them. See README.md.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/specimens.h"
#include "tests/support/watched_process.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Options {
  fs::path program, keep;
  std::uint64_t cases = 20000, seed = 1;
  double seconds = 0;  // 0: as long as it takes
  std::int64_t only_case = -1;
  std::string only_specimen;
  std::size_t jobs = 2;
  std::uint64_t memory_mib = 512;
  bool verbose = false;
};

constexpr double longest_s = 10;

// What happened in one case.
struct CaseResult {
  std::string specimen, mutation, command, problem;
  ProcessEnd end;
  bool stopped = false;  // a run that was asked for much, and ended when told to
};

bool is_run(const Words& words) {
  return words.front() == "run" || words.front() == "ingest" || words.front() == "stitch";
}

// Exit code 1 with the damage on standard output.
bool may_find(const Words& words) {
  return words.front() == "verify" || words.front() == "status" || words.back() == "--check" ||
         words.back() == "--json";
}

class Fuzzer {
 public:
  Fuzzer(const Options& options, const fs::path& root) : options_(options), root_(root) {
    for (Specimen& specimen : make_specimens(options.program, root / "specimens"))
      if (specimen.name.starts_with(options.only_specimen))
        specimens_.push_back(std::move(specimen));
    if (specimens_.empty()) throw std::runtime_error("no specimen begins with that name");
  }

  // Whether nothing went wrong.
  bool run() {
    const auto begin = Clock::now();
    const auto take_cases = [&](std::size_t job) {
      for (;;) {
        const std::uint64_t index = next_++;
        if (index >= options_.cases || (options_.seconds > 0 && since(begin) > options_.seconds))
          return;
        if (options_.only_case >= 0 && index != static_cast<std::uint64_t>(options_.only_case))
          continue;
        tell(index, job, run_case(index, job));
      }
    };
    std::vector<std::jthread> jobs;
    for (std::size_t job = 0; job < options_.jobs; ++job) jobs.emplace_back(take_cases, job);
    jobs.clear();
    fmt::print(
        "{} cases of {} kinds in {:.0f} s with seed {}: {} accepted, {} refused, {} stopped "
        "after {:.0f} s, {} failed; peak memory {} MiB, longest {:.2f} s\n",
        done_, specimens_.size(), since(begin), options_.seed, accepted_, refused_, stopped_,
        longest_s, failed_, peak_memory_ >> 20, longest_);
    for (const auto& [problem, count] : problems_) fmt::print("  {} x {}\n", count, problem);
    return failed_ == 0;
  }

 private:
  static double since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  fs::path case_folder(std::size_t job) const { return root_ / fmt::format("job{}", job) / "case"; }

  // A fresh copy of the specimen. Times stay: they are in what a run remembers.
  fs::path copy_of(const Specimen& specimen, std::size_t job) const {
    fs::path folder = case_folder(job);
    fs::remove_all(folder);
    fs::create_directories(folder.parent_path());
    fs::copy(specimen.folder, folder, fs::copy_options::recursive);
    return folder;
  }

  CaseResult run_case(std::uint64_t index, std::size_t job) {
    Random random(options_.seed * 1000003 + index);
    const Specimen& specimen = pick_from(random, specimens_);
    const fs::path folder = copy_of(specimen, job);
    std::string mutation, target = specimen.targets.front();
    // Now and then nothing is changed: then it must work.
    const bool sound = pick(random, 25) == 0;
    const std::size_t times = sound ? 0 : 1 + (pick(random, 6) == 0 ? pick(random, 3) : 0);
    for (std::size_t i = 0; i < times; ++i) {
      target = pick_from(random, specimen.targets);
      const Specimen& other = pick_from(random, specimens_);
      const std::string bytes = bytes_of_file(other.folder / pick_from(random, other.targets));
      if (std::error_code none; !fs::is_regular_file(folder / target, none)) continue;
      mutation += fmt::format("{}{}: {}", mutation.empty() ? "" : "; ", target,
                              mutate_file(folder / target, bytes, random));
    }
    const Words& words = pick_from(random, specimen.commands);
    CaseResult result = command_result(specimen, folder, words, target);
    result.mutation = sound ? "unchanged" : mutation;
    const bool always = words[1] != "@" && words.front() != "status";  // not of every file
    if (sound && always && result.problem.empty() && result.end.exit_code != 0)
      result.problem = "a sound file is refused";
    return result;
  }

  CaseResult command_result(const Specimen& specimen, const fs::path& folder, Words words,
                            const std::string& target) const {
    for (std::string& word : words)
      if (word == "@") word = target;
    CaseResult result;
    result.specimen = specimen.name;
    words.insert(words.begin(), options_.program.string());
    result.command = shell_text(words);
    words.erase(words.begin());
    result.end = start(folder, words, result.stopped);
    result.problem = result.stopped ? "" : complaint_of(result.end, may_find(words));
    std::error_code none;
    if (result.problem.empty() && words.front() == "run" && result.end.exit_code == 0 &&
        fs::exists(folder / "case.mesh", none))
      result.problem = check_output(specimen, folder, words);
    return result;
  }

  // A run may have been asked for more than the time allows. Then it is to stop when told.
  ProcessEnd start(const fs::path& folder, const Words& words, bool& stopped) const {
    Words command = {options_.program.string()};
    command.insert(command.end(), words.begin(), words.end());
    const ProcessLimits limits{longest_s, is_run(words), options_.memory_mib << 20};
    const fs::path capture = folder.parent_path() / "said";
    ProcessEnd end = run_watched(command, folder, capture, limits);
    stopped = end.asked && complaint_of(end, false).empty() && end.exit_code == 1;
    return end;
  }

  // Of a run that says that all is well.
  std::string check_output(const Specimen& specimen, const fs::path& folder,
                           const Words& words) const {
    bool ignored = false;
    if (words.back() == "--dry-run") return {};
    const ProcessEnd verified = start(folder, {"verify", "case.mesh"}, ignored);
    if (verified.exit_code != 0)
      return "a run is content, verify is not: " + verified.out + verified.err;
    if (specimen.clean.empty() || words.size() > 2) return {};
    const auto files = output_files(folder / "case.mesh");
    for (const auto& [name, bytes] : specimen.clean) {
      const auto found = files.find(name);
      if (found == files.end() || found->second != bytes) return "a run leaves another " + name;
    }
    return {};
  }

  void tell(std::uint64_t index, std::size_t job, const CaseResult& result) {
    const std::lock_guard lock(mutex_);
    ++done_;
    peak_memory_ = std::max(peak_memory_, result.end.peak_memory);
    longest_ = std::max(longest_, result.end.seconds);
    if (options_.verbose)
      fmt::print("{} {} [{}] {}: exit {}\n{}", index, result.specimen, result.mutation,
                 result.command, result.end.exit_code, result.end.err);
    if (result.stopped)
      ++stopped_;
    else if (result.problem.empty())
      ++(result.end.exit_code == 0 ? accepted_ : refused_);
    if (result.problem.empty()) return;
    ++failed_;
    const std::string first_line = result.problem.substr(0, result.problem.find('\n'));
    const std::size_t seen =
        ++problems_[fmt::format("{}: {}", result.specimen, first_line.substr(0, 100))];
    if (seen > 5) return;  // enough of its kind
    const fs::path kept = keep(index, job, result);
    fmt::print("case {}: {}\n  {}\n  {}\n  {}\n  kept in {}; again: --seed {} --case {}{}\n", index,
               first_line, result.mutation, result.command,
               result.end.err.substr(0, result.end.err.find('\n')), kept.string(), options_.seed,
               index, options_.only_specimen.empty() ? "" : " --only " + options_.only_specimen);
    std::fflush(stdout);
  }

  fs::path keep(std::uint64_t index, std::size_t job, const CaseResult& result) const {
    fs::path kept = options_.keep / fmt::format("seed{}-case{}", options_.seed, index);
    std::error_code ignored;
    fs::remove_all(kept, ignored);
    fs::create_directories(options_.keep);
    fs::copy(case_folder(job), kept, fs::copy_options::recursive | fs::copy_options::copy_symlinks,
             ignored);
    fs::create_directories(kept);
    write_bytes(kept / "fuzz.txt",
                fmt::format("{}\n{}\n{}\n{}\nexit code {}, signal {}, {:.2f} s, {} bytes\n\n{}\n{}",
                            result.specimen, result.mutation, result.command, result.problem,
                            result.end.exit_code, result.end.signal, result.end.seconds,
                            result.end.peak_memory, result.end.out, result.end.err));
    return kept;
  }

  Options options_;
  fs::path root_;
  std::vector<Specimen> specimens_;
  std::atomic<std::uint64_t> next_ = 0;
  std::mutex mutex_;
  std::uint64_t done_ = 0, accepted_ = 0, refused_ = 0, stopped_ = 0, failed_ = 0;
  std::uint64_t peak_memory_ = 0;
  double longest_ = 0;
  std::map<std::string, std::size_t> problems_;
};

constexpr const char* usage =
    "usage: fuzz_files PROGRAM [--cases N] [--seed S] [--seconds T] [--jobs N] [--case N]\n"
    "                  [--only SPECIMEN] [--keep FOLDER] [--memory MIB] [--verbose]\n";

Options parse(int argc, char** argv) {
  Options options;
  if (argc < 2 || argv[1][0] == '-') throw std::invalid_argument(usage);
  options.program = fs::absolute(argv[1]);
  options.keep = fs::temp_directory_path() / "voxweld-fuzz-failures";
  for (int i = 2; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--verbose") {
      options.verbose = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument(usage);
    const std::string value = argv[++i];
    if (name == "--cases")
      options.cases = std::stoull(value);
    else if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--seconds")
      options.seconds = std::stod(value);
    else if (name == "--jobs")
      options.jobs = std::stoull(value);
    else if (name == "--case")
      options.only_case = std::stoll(value);
    else if (name == "--only")
      options.only_specimen = value;
    else if (name == "--keep")
      options.keep = fs::absolute(value);
    else if (name == "--memory")
      options.memory_mib = std::stoull(value);
    else
      throw std::invalid_argument(usage);
  }
  return options;
}

int run_fuzzer(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const rlimit no_core{0, 0}, small_files{std::uint64_t{1} << 31, std::uint64_t{1} << 31};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_FSIZE, &small_files);
  std::string root = (fs::temp_directory_path() / "voxweld-fuzz-XXXXXX").string();
  if (mkdtemp(root.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  const auto remove_root = [](const fs::path* path) {
    std::error_code ignored;
    fs::remove_all(*path, ignored);
  };
  const fs::path path = root;
  const std::unique_ptr<const fs::path, decltype(remove_root)> cleared(&path, remove_root);
  return Fuzzer(options, path).run() ? 0 : 1;
}

}  // namespace
}  // namespace voxweld::testing

int main(int argc, char** argv) try {
  return voxweld::testing::run_fuzzer(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
