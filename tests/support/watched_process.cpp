#include "tests/support/watched_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

double now_s() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

std::string text_in(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  return text;
}

// The test's own variables but those that are named, and then these.
std::vector<std::string> environment_with(const Variables& variables) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('='));
    const bool replaced = std::any_of(variables.begin(), variables.end(),
                                      [&](const auto& v) { return v.first == name; });
    if (!replaced) all.push_back(text);
  }
  for (const auto& [name, value] : variables) all.push_back(fmt::format("{}={}", name, value));
  return all;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

WatchedProcess::WatchedProcess(const std::vector<std::string>& command, const fs::path& directory,
                               const fs::path& capture, const Variables& variables)
    : started_(now_s()), capture_(capture) {
  std::vector<std::string> arguments = command, environment = environment_with(variables);
  const std::vector<char*> argv = pointers_to(arguments), envp = pointers_to(environment);
  const std::string out = capture.string() + ".out", err = capture.string() + ".err";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), flags, 0644);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), flags, 0644);
  posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  const int failed =
      posix_spawn(&process_, argv.front(), &actions, nullptr, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0)
    throw std::runtime_error("cannot start " + command.front() + ": " + std::strerror(failed));
  handle_ = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
  if (handle_ < 0) throw std::runtime_error("pidfd_open failed");
}

WatchedProcess::WatchedProcess(WatchedProcess&& other) noexcept
    : process_(other.process_),
      handle_(std::exchange(other.handle_, -1)),
      ended_(std::exchange(other.ended_, true)),
      started_(other.started_),
      capture_(std::move(other.capture_)),
      end_(std::move(other.end_)) {}

WatchedProcess::~WatchedProcess() {
  if (!ended_) {
    send(SIGKILL);
    while (!poll_once(1)) {
    }
  }
  if (handle_ >= 0) close(handle_);
}

void WatchedProcess::send(int signal) const {
  if (!ended_) kill(process_, signal);
}

bool WatchedProcess::poll_once(double seconds) {
  if (ended_) return true;
  pollfd watched{handle_, POLLIN, 0};
  poll(&watched, 1, static_cast<int>(std::max(0.0, seconds) * 1000));
  int status = 0;
  rusage used{};
  if (wait4(process_, &status, WNOHANG, &used) != process_) return false;
  ended_ = true;
  end_.seconds = now_s() - started_;
  end_.peak_memory = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  if (WIFEXITED(status)) end_.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end_.signal = WTERMSIG(status);
  return true;
}

std::uint64_t WatchedProcess::resident_bytes() const {
  std::ifstream in("/proc/" + std::to_string(process_) + "/statm");
  std::uint64_t size = 0, resident = 0;
  in >> size >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

double WatchedProcess::processor_seconds() const {
  std::ifstream in("/proc/" + std::to_string(process_) + "/stat");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.erase(0, std::min(text.size(), text.rfind(')') + 1));  // the name may have blanks in it
  std::istringstream fields(text);
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

bool WatchedProcess::wait_for(double seconds) {
  const double until = now_s() + seconds;
  do {
    if (poll_once(until - now_s())) return true;
  } while (now_s() < until);
  return false;
}

ProcessEnd WatchedProcess::wait(const ProcessLimits& limits) {
  constexpr double look_s = 0.03, clock_factor = 6;
  double limit = limits.seconds;
  while (!poll_once(look_s)) {
    const bool over = processor_seconds() > limit || now_s() - started_ > clock_factor * limit;
    if (over && limits.ask_first && !end_.asked) {
      end_.asked = true;
      limit *= 2;
      send(SIGINT);
    } else if (over) {
      end_.timed_out = true;
    }
    if (resident_bytes() > limits.memory) end_.too_large = true;
    if (end_.timed_out || end_.too_large) send(SIGKILL);
  }
  end_.too_large = end_.too_large || end_.peak_memory > limits.memory;
  end_.out = text_in(capture_.string() + ".out");
  end_.err = text_in(capture_.string() + ".err");
  return end_;
}

ProcessEnd run_watched(const std::vector<std::string>& command, const fs::path& directory,
                       const fs::path& capture, const ProcessLimits& limits,
                       const Variables& variables) {
  return WatchedProcess(command, directory, capture, variables).wait(limits);
}

std::string shell_text(const std::vector<std::string>& command) {
  std::string text;
  for (const std::string& word : command) {
    if (!text.empty()) text += ' ';
    const bool plain =
        !word.empty() && word.find_first_of(" '\"\\*?[]{}$&|;<>()#~`!") == std::string::npos;
    text += plain ? word : "'" + word + "'";
  }
  return text;
}

std::string complaint_of(const ProcessEnd& end, bool finding) {
  // What only libraries and their exceptions say.
  static constexpr std::array raw = {"what()",
                                     "std::",
                                     "json.exception",
                                     "parse_error.",
                                     "type_error.",
                                     "out_of_range",
                                     "boost",
                                     "terminate",
                                     "basic_string",
                                     "vector::",
                                     "map::at",
                                     "bad_alloc",
                                     "toml::",
                                     "CLI::",
                                     "_M_",
                                     "stoi",
                                     "stod",
                                     "nlohmann",
                                     "filesystem error",
                                     "Sanitizer",
                                     "runtime error:",
                                     "Assertion",
                                     "bad optional",
                                     "bad_variant"};
  if (end.timed_out) return "took too long";
  if (end.too_large) return "took too much memory";
  if (end.signal != 0) return "ended by signal " + std::to_string(end.signal);
  if (end.exit_code < 0 || end.exit_code > 2) return "exit code " + std::to_string(end.exit_code);
  for (const char* words : {"internal error", "This is a bug", "unexpected error"})
    if (end.err.find(words) != std::string::npos) return "calls itself a bug";
  for (const char* words : raw)
    if (end.err.find(words) != std::string::npos) return std::string("a library's words: ") + words;
  int errors = 0;
  std::istringstream lines(end.err);
  for (std::string line; std::getline(lines, line);) errors += line.starts_with("error: ") ? 1 : 0;
  if (errors > 1) return "more than one error";
  if (end.exit_code == 0 && errors > 0) return "an error, and exit code 0";
  const bool said = errors == 1 || (finding && end.exit_code == 1 && !end.out.empty());
  if (end.exit_code != 0 && !said) return "no error is told";
  return {};
}

}  // namespace voxweld::testing
