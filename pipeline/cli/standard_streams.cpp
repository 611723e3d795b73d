#include "pipeline/cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

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
  const int error = errno != 0 ? errno : EIO;
  throw StorageError(std::string("cannot write to standard output: ") + std::strerror(error),
                     error);
}

bool standard_output_failed() {
  return std::ferror(stdout) != 0;
}

}  // namespace voxweld
