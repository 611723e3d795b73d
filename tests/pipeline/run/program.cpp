#include "tests/pipeline/run/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>

#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double longest_run_s = 120;

using Capture = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Capture open_capture() {
  Capture file(std::tmpfile(), std::fclose);
  if (!file) throw std::runtime_error("tmpfile failed");
  return file;
}

std::string text_of(const Capture& file) {
  std::string text;
  std::rewind(file.get());
  char piece[4096];
  while (const std::size_t got = std::fread(piece, 1, sizeof piece, file.get()))
    text.append(piece, got);
  return text;
}

pid_t start(const Arguments& arguments, const Capture& out, const Capture& err) {
  std::vector<char*> argv;
  std::string name = program_path().string();
  std::vector<std::string> owned = arguments;
  argv.push_back(name.data());
  for (std::string& argument : owned) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child > 0) return child;
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(fileno(out.get()), STDOUT_FILENO);
  dup2(fileno(err.get()), STDERR_FILENO);
  execv(name.c_str(), argv.data());
  _exit(127);
}

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Arguments set_options(const std::vector<std::string>& settings) {
  Arguments options;
  for (const std::string& setting : settings) options.insert(options.end(), {"--set", setting});
  return options;
}

Environment::Environment(std::vector<std::pair<std::string, std::string>> variables) {
  for (const auto& [name, value] : variables) {
    const char* earlier = std::getenv(name.c_str());
    earlier_.emplace_back(name, earlier == nullptr ? std::nullopt : std::optional(earlier));
    setenv(name.c_str(), value.c_str(), 1);
  }
}

Environment::~Environment() {
  for (const auto& [name, value] : earlier_)
    if (value)
      setenv(name.c_str(), value->c_str(), 1);
    else
      unsetenv(name.c_str());
}

ProgramResult run_voxweld(const Arguments& arguments, std::optional<Stop> stop) {
  const Capture out = open_capture(), err = open_capture();
  const auto begin = Clock::now();
  const pid_t child = start(arguments, out, err);
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    const double now = since(begin);
    if (stop && now >= stop->after_s) {
      kill(child, stop->signal);
      stop.reset();
    }
    if (now > longest_run_s) kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  ProgramResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.seconds = since(begin);
  result.out = text_of(out);
  result.err = text_of(err);
  return result;
}

}  // namespace voxweld::testing
