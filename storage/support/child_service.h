// A child process that stays, to be asked one thing after the other: for libraries that crash at
// damaged files, and whose state would be costly to build again for each question.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace voxweld {

// What became of a call.
struct CallEnd {
  enum class Kind : std::uint8_t { done, failed, crashed, out_of_time };
  Kind kind = Kind::done;
  std::string why{};  // of `failed`: what was thrown, one line of printable characters
};

struct ServiceRules {
  unsigned most_seconds = 0;          // of the processor for a call, of the clock ten times as many
  std::uint64_t most_more_bytes = 0;  // as ChildRules has it
};

// One call at a time. The child ends with the service, or with this process, whatever ends that. It
// holds no file of this process open.
class ChildService {
 public:
  // serve(memory) runs in the child for each call. Both processes see `memory`, which begins as
  // zeros; the pages nobody writes take no room. Throws StorageError where no child can be made.
  ChildService(std::size_t bytes, std::function<void(std::span<std::byte>)> serve,
               const ServiceRules& rules);
  ~ChildService();
  ChildService(const ChildService&) = delete;
  ChildService& operator=(const ChildService&) = delete;

  std::span<std::byte> memory() const;
  // Has the child serve once. After a crash, or where the time was over, every call ends so.
  CallEnd call();

  // In the child, within serve: does a part of it in a child of its own. What that takes of memory
  // is given back, and it sees all that this one has. Throws what went wrong as text.
  static void apart(const std::function<void()>& what, const ServiceRules& rules);

 private:
  struct Shared;
  [[noreturn]] void run_child(int socket,
                              const std::function<void(std::span<std::byte>)>& serve) const;
  CallEnd ended();
  Shared& shared() const;

  std::size_t bytes_;
  ServiceRules rules_;
  void* map_ = nullptr;
  int socket_ = -1;
  int child_ = 0;  // 0: it has ended
  CallEnd last_;
};

}  // namespace voxweld
