// The moments at which a run's files change: preloaded, numbers the renames into place and the
// removals of files below VOXWELD_POINTS_BELOW, each a moment before and one after it, by
// their paths below that folder. They are listed in the file VOXWELD_POINTS_LIST, a line each; at
// the one that VOXWELD_POINTS_AT names the process is sent the signal VOXWELD_POINTS_SIGNAL. At the
// one that is the VOXWELD_POINTS_NTH with VOXWELD_POINTS_WITH in it the shell is given
// VOXWELD_POINTS_DO.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

const char* setting(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? "" : text;
}

// Temporary and scratch files have names of their own in each process, and are of no run.
bool counts(const std::string& path) {
  static const std::string below = setting("VOXWELD_POINTS_BELOW");
  return !below.empty() && path.starts_with(below) && path.find(".tmp-") == std::string::npos &&
         path.find("/scratch-") == std::string::npos;
}

// A spool's name has its process in it: "spool-<layer>-..." is "spool-<layer>".
std::string told(const std::string& path) {
  const std::size_t spool = path.find("/spool-");
  if (spool == std::string::npos) return path;
  const std::size_t process = path.find('-', spool + 7);
  return path.substr(0, process) + path.substr(path.find('.', process));
}

void do_at_nth(const std::string& point) {
  static const std::string with = setting("VOXWELD_POINTS_WITH");
  static std::atomic<int> left = std::atoi(setting("VOXWELD_POINTS_NTH"));
  if (with.empty() || point.find(with) == std::string::npos || --left != 0) return;
  const std::string command = std::string("unset LD_PRELOAD; ") + setting("VOXWELD_POINTS_DO");
  if (std::system(command.c_str()) != 0) std::abort();
}

void reach(const char* moment, const char* change, const std::string& path) {
  static const std::string list = setting("VOXWELD_POINTS_LIST"), at = setting("VOXWELD_POINTS_AT");
  const std::string point = std::string(moment) + " " + change + " " +
                            told(path.substr(std::strlen(setting("VOXWELD_POINTS_BELOW"))));
  if (!list.empty()) {
    const int file = open(list.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0 || dprintf(file, "%s\n", point.c_str()) < 0) std::abort();
    close(file);
  }
  if (point == at) kill(getpid(), std::atoi(setting("VOXWELD_POINTS_SIGNAL")));
  do_at_nth(point);
}

template <class F>
F next(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

template <class Change>
int around(const char* change, const char* path, const Change& real) {
  if (!counts(path) || access(path, F_OK) != 0) return real();
  reach("before", change, path);
  const int result = real();
  reach("after", change, path);
  return result;
}

}  // namespace

extern "C" {

int rename(const char* from, const char* to) {
  static const auto real = next(&rename, "rename");
  if (!counts(to)) return real(from, to);
  reach("before", "rename", to);
  const int result = real(from, to);
  reach("after", "rename", to);
  return result;
}

int unlink(const char* path) {
  static const auto real = next(&unlink, "unlink");
  return around("removal", path, [&] { return real(path); });
}

int remove(const char* path) {
  static const auto real = next(&remove, "remove");
  return around("removal", path, [&] { return real(path); });
}
}
