// Runs a command and writes what it took as JSON: its exit code (128 and the number of what killed
// it), seconds of wall and processor, peak of memory, bytes it asked to read and write (of files
// and all else). A small program, as a child's peak starts with that of who started it.
// Usage: timed_run FIGURES.json COMMAND...
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>

namespace {

struct Bytes {
  unsigned long long read = 0, written = 0;
};

// Of this process and those of its children that it has waited for.
Bytes bytes_so_far() {
  Bytes bytes;
  std::ifstream file("/proc/self/io");
  std::string key;
  for (unsigned long long value = 0; file >> key >> value;) {
    if (key == "rchar:") bytes.read = value;
    if (key == "wchar:") bytes.written = value;
  }
  return bytes;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: timed_run FIGURES.json COMMAND...\n");
    return 2;
  }
  const Bytes before = bytes_so_far();
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    execvp(argv[2], argv + 2);
    std::fprintf(stderr, "timed_run: cannot run %s\n", argv[2]);
    _exit(127);
  }
  int status = 0;
  rusage used{};
  if (child < 0 || wait4(child, &status, 0, &used) != child) {
    std::fprintf(stderr, "timed_run: cannot start a process\n");
    return 1;
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const Bytes after = bytes_so_far();
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::ofstream file(argv[1]);
  file << "{\"exit_code\": " << code << ", \"wall_s\": " << wall.count()
       << ", \"cpu_s\": " << seconds(used.ru_utime) + seconds(used.ru_stime)
       << ", \"peak_bytes\": " << 1024LL * used.ru_maxrss
       << ", \"read_bytes\": " << after.read - before.read
       << ", \"written_bytes\": " << after.written - before.written << "}\n";
  if (!file.flush()) {
    std::fprintf(stderr, "timed_run: %s: cannot write\n", argv[1]);
    return 1;
  }
  return code;
}
