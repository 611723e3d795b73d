// A network file system where there is none: preloaded (LD_PRELOAD=slow_files.so), each of the
// calls that such a file system answers from its server takes VOXWELD_FILE_DELAY_US microseconds
// (1000) longer, and at its end the process says how many it made. Only for files below
// VOXWELD_FILE_DELAY_BELOW, where that is set. Reads and writes of what is open are as fast as
// ever: clients read ahead and write behind.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<unsigned long> opens{0}, looks{0}, changes{0};

struct Settings {
  useconds_t delay = 1000;
  const char* below = nullptr;
  Settings() {
    if (const char* text = std::getenv("VOXWELD_FILE_DELAY_US"))
      delay = static_cast<useconds_t>(std::atol(text));
    below = std::getenv("VOXWELD_FILE_DELAY_BELOW");
  }
};

void wait_for_server(std::atomic<unsigned long>& counter, const char* path) {
  static const Settings settings;
  if (path == nullptr) return;
  if (settings.below != nullptr && std::strncmp(path, settings.below, std::strlen(settings.below)))
    return;
  ++counter;
  usleep(settings.delay);
}

template <class F>
F next(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

struct Report {
  ~Report() {
    std::fprintf(stderr, "slow_files: %lu opens, %lu looks, %lu changes\n", opens.load(),
                 looks.load(), changes.load());
  }
} report;

mode_t mode_of(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  wait_for_server(opens, path);
  static const auto real = next(&open, "open");
  return real(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  wait_for_server(opens, path);
  static const auto real = next(&open64, "open64");
  return real(path, flags, mode);
}

int stat(const char* path, struct stat* out) {
  wait_for_server(looks, path);
  static const auto real = next(&stat, "stat");
  return real(path, out);
}

int lstat(const char* path, struct stat* out) {
  wait_for_server(looks, path);
  static const auto real = next(&lstat, "lstat");
  return real(path, out);
}

int rename(const char* from, const char* to) {
  wait_for_server(changes, from);
  static const auto real = next(&rename, "rename");
  return real(from, to);
}

int unlink(const char* path) {
  wait_for_server(changes, path);
  static const auto real = next(&unlink, "unlink");
  return real(path);
}

int mkdir(const char* path, mode_t mode) {
  wait_for_server(changes, path);
  static const auto real = next(&mkdir, "mkdir");
  return real(path, mode);
}
}
