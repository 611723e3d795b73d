// When and how large a file was.
#pragma once

#include <cstdint>

namespace voxweld {

// What tells a file from what it was. The system moves the time of change with every write, also
// where the time of modification is set back afterwards.
struct FileState {
  std::uint64_t size = 0;
  std::int64_t mtime_ns = 0, ctime_ns = 0;  // of modification, of change
  friend bool operator==(const FileState&, const FileState&) = default;
};

}  // namespace voxweld
