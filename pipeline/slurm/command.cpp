#include "pipeline/slurm/command.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void throw_cannot_run(const std::string& program, int error) {
  throw StorageError("cannot run " + program + ": " + std::strerror(error), error);
}

// An open file, closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    number_ = std::exchange(other.number_, -1);
    return *this;
  }
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  void close() {
    if (is_open()) ::close(std::exchange(number_, -1));
  }

 private:
  int number_;
};

// A file in memory, not a pipe: a program that does not read its input can neither block us nor end
// us with SIGPIPE.
Descriptor input_file(const std::string& program, const std::string& text) {
  Descriptor file(memfd_create("input", MFD_CLOEXEC));
  if (!file.is_open()) throw_cannot_run(program, errno);
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = write(file.number(), text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_cannot_run(program, errno);
    done += static_cast<std::size_t>(count);
  }
  if (lseek(file.number(), 0, SEEK_SET) < 0) throw_cannot_run(program, errno);
  return file;
}

struct Pipe {
  Descriptor read_end, write_end;
};

Pipe make_pipe(const std::string& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_cannot_run(program, errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

std::vector<char*> environment(const std::vector<std::string>& hidden) {
  std::vector<char*> kept;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
    const bool hide = std::any_of(hidden.begin(), hidden.end(), [&](const std::string& name) {
      return std::string_view(*variable).starts_with(name);
    });
    if (!hide) kept.push_back(*variable);
  }
  kept.push_back(nullptr);
  return kept;
}

std::vector<char*> argument_pointers(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

// What posix_spawn is told, released at the end.
class SpawnSetup {
 public:
  SpawnSetup() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;

  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
};

// Signals as a fresh process has them, whatever this one blocks or ignores.
void set_signals(posix_spawnattr_t& attributes) {
  sigset_t blocked;
  sigset_t by_default;
  sigemptyset(&blocked);
  sigemptyset(&by_default);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGCHLD})
    sigaddset(&by_default, signal);
  posix_spawnattr_setsigmask(&attributes, &blocked);
  posix_spawnattr_setsigdefault(&attributes, &by_default);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
}

pid_t spawn(std::vector<std::string> words, const CommandOptions& options, const Pipe& out,
            const Pipe& err) {
  const Descriptor input = input_file(words[0], options.input);
  SpawnSetup setup;
  posix_spawn_file_actions_adddup2(&setup.actions, input.number(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&setup.actions, out.write_end.number(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&setup.actions, err.write_end.number(), STDERR_FILENO);
  set_signals(setup.attributes);
  const std::vector<char*> variables = environment(options.hidden_variables);
  const std::vector<char*> arguments = argument_pointers(words);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &setup.actions, &setup.attributes,
                                 arguments.data(), variables.data());
  if (error != 0) throw_cannot_run(words[0], error);
  return child;
}

// Appends what there is to read; closes the pipe at its end.
void drain(Descriptor& pipe, std::string& text) {
  std::array<char, 16384> buffer;
  const ssize_t count = read(pipe.number(), buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) pipe.close();
}

// Reads both pipes to their ends; false when the time is up before.
bool read_all(Descriptor& out, Descriptor& err, CommandResult& result, Clock::time_point deadline) {
  while (out.is_open() || err.is_open()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return false;
    constexpr std::int64_t longest = 60000;  // poll's argument is an int
    std::array<pollfd, 2> polled = {{{out.number(), POLLIN, 0}, {err.number(), POLLIN, 0}}};
    const int ready = poll(polled.data(), polled.size(),
                           static_cast<int>(std::min<std::int64_t>(left.count(), longest)));
    if (ready <= 0) continue;  // a signal to us, or the time: asked for above
    if (polled[0].revents != 0) drain(out, result.out);
    if (polled[1].revents != 0) drain(err, result.err);
  }
  return true;
}

int exit_code_of(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// A program may close its output long before it ends.
bool ended_by(pid_t child, int& status, Clock::time_point deadline) {
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return true;
    if (ended < 0 && errno != EINTR) return true;  // reaped by someone else: nothing to wait for
    if (Clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

CommandResult run_command(std::span<const std::string> words, const CommandOptions& options) {
  const auto deadline = Clock::now() + options.time_limit;
  Pipe out = make_pipe(words[0]);
  Pipe err = make_pipe(words[0]);
  const pid_t child = spawn({words.begin(), words.end()}, options, out, err);
  out.write_end.close();  // or the pipes would never end
  err.write_end.close();

  CommandResult result;
  int status = 0;
  const bool whole = read_all(out.read_end, err.read_end, result, deadline);
  if (!whole || !ended_by(child, status, deadline)) {
    result.timed_out = true;
    kill(-child, SIGKILL);  // the group: what the program started goes with it
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  result.exit_code = exit_code_of(status);
  return result;
}

}  // namespace voxweld
