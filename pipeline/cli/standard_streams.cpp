#include "pipeline/cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>

#include "storage/support/error.h"

namespace voxweld {

void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest number that is free is this one.
    if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

void finish_standard_output() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && !standard_output_failed()) return;
  // Where a write failed before, nobody knows any more why.
  throw_errno("write to", "standard output", errno != 0 ? errno : EIO);
}

bool standard_output_failed() {
  return std::ferror(stdout) != 0;
}

}  // namespace voxweld
