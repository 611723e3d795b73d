#include "storage/support/child_service.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "storage/support/child_process.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t why_bytes = 400;
constexpr std::size_t memory_at = 512;  // behind Shared

void keep_text(char (&to)[why_bytes], const char* text) {
  std::strncpy(to, text, why_bytes - 1);
  to[why_bytes - 1] = '\0';
}

// What others wrote, for a message.
std::string plain_text(char (&from)[why_bytes]) {
  from[why_bytes - 1] = '\0';
  std::string text = from;
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c > '~'; }, ' ');
  return text;
}

void* map_shared(std::size_t bytes) {
  void* const map = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (map == MAP_FAILED) throw StorageError("cannot map memory for a child process", errno);
  return map;
}

bool send_byte(int socket) {
  const char byte = 1;
  ssize_t sent = 0;
  do sent = send(socket, &byte, 1, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == 1;
}

bool receive_byte(int socket) {
  char byte = 0;
  ssize_t got = 0;
  do got = recv(socket, &byte, 1, 0);
  while (got < 0 && errno == EINTR);
  return got == 1;
}

// From now on for so many seconds.
void limit_time(unsigned seconds) {
  rusage used{};
  rlimit limit{};
  if (getrusage(RUSAGE_SELF, &used) != 0 || getrlimit(RLIMIT_CPU, &limit) != 0) return;
  const auto spent = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, spent + seconds + 1);
  setrlimit(RLIMIT_CPU, &limit);
  alarm(10 * seconds + 10);  // later than that of a child of the child
}

}  // namespace

struct ChildService::Shared {
  std::int32_t done;
  char why[why_bytes];
};

ChildService::Shared& ChildService::shared() const {
  return *static_cast<Shared*>(map_);
}

std::span<std::byte> ChildService::memory() const {
  return {static_cast<std::byte*>(map_) + memory_at, bytes_};
}

ChildService::ChildService(std::size_t bytes, std::function<void(std::span<std::byte>)> serve,
                           const ServiceRules& rules)
    : bytes_(bytes), rules_(rules) {
  static_assert(sizeof(Shared) <= memory_at);
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw StorageError("cannot make a socket for a child process", errno);
  map_ = map_shared(memory_at + bytes_);
  const std::optional<int> child =
      start_child([&] { run_child(ends[1], serve); }, {.most_more_bytes = rules.most_more_bytes});
  const int error = errno;
  close(ends[1]);
  socket_ = ends[0];
  if (!child) {
    close(socket_);
    munmap(map_, memory_at + bytes_);
    throw StorageError("cannot start a child process", error);
  }
  child_ = *child;
}

ChildService::~ChildService() {
  close(socket_);
  if (child_ > 0) {
    kill(child_, SIGKILL);  // it has nothing to tidy
    wait_for_child(child_);
  }
  munmap(map_, memory_at + bytes_);
}

void ChildService::run_child(int socket,
                             const std::function<void(std::span<std::byte>)>& serve) const {
  // Files of the parent's stay its own: its locks, and the ends of its other pipes.
  const auto end = static_cast<unsigned>(socket);
  if (end > 3) close_range(3, end - 1, 0);
  close_range(end + 1, ~0U, 0);
  // A Ctrl-C is for the parent to see to, which then ends this.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  while (receive_byte(socket)) {
    limit_time(rules_.most_seconds);
    try {
      serve(memory());
      shared().done = 1;
    } catch (const std::exception& failure) {
      keep_text(shared().why, failure.what());
    }
    alarm(0);
    if (!send_byte(socket)) break;
  }
  _exit(0);
}

CallEnd ChildService::ended() {
  const TrialEnd end = trial_end(wait_for_child(std::exchange(child_, 0)));
  return {.kind =
              end == TrialEnd::out_of_time ? CallEnd::Kind::out_of_time : CallEnd::Kind::crashed};
}

CallEnd ChildService::call() {
  if (child_ == 0) return last_;
  shared().done = 0;
  shared().why[0] = '\0';
  if (!send_byte(socket_) || !receive_byte(socket_)) return last_ = ended();
  if (shared().done == 1) return {};
  return {.kind = CallEnd::Kind::failed, .why = plain_text(shared().why)};
}

void ChildService::apart(const std::function<void()>& what, const ServiceRules& rules) {
  const auto unmap = [](Shared* shared) { munmap(shared, sizeof(Shared)); };
  const std::unique_ptr<Shared, decltype(unmap)> shared(
      static_cast<Shared*>(map_shared(sizeof(Shared))), unmap);
  const auto guarded = [&] {
    try {
      what();
      shared->done = 1;
    } catch (const std::exception& failure) {
      keep_text(shared->why, failure.what());
    }
  };
  const auto status = run_in_child(
      guarded, {.most_seconds = rules.most_seconds, .most_more_bytes = rules.most_more_bytes});
  if (!status) throw std::runtime_error("no process can be started to decode them");
  if (shared->done == 1) return;
  if (trial_end(*status) == TrialEnd::out_of_time)
    throw std::runtime_error(fmt::format("that takes more than {} s", rules.most_seconds));
  if (WIFSIGNALED(*status))
    throw std::runtime_error(fmt::format("it ends by signal {}", WTERMSIG(*status)));
  throw std::runtime_error(plain_text(shared->why));
}

}  // namespace voxweld
