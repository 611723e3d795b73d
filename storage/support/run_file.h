// Runs of records in one scratch file: written one behind the other, and each read from its begin
// to its end through a window that moves on.
#pragma once

#include <cstring>
#include <vector>

#include "storage/support/scratch_file.h"

namespace voxweld {

struct RunExtent {
  std::uint64_t begin = 0, end = 0;  // bytes of the file
};

class RunFile {
 public:
  // As ScratchFile.
  explicit RunFile(const std::filesystem::path& folder) : file_(folder) {}

  // At the end of the run under way. Holds 64 KiB of it.
  void write(std::span<const std::byte> bytes) {
    if (pending_.size() + bytes.size() > pending_bytes) return write_through(bytes);
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  }
  RunExtent end_run();
  // Precondition: that run was ended.
  void read(std::uint64_t offset, std::span<std::byte> out) const { file_.read(offset, out); }

 private:
  static constexpr std::size_t pending_bytes = std::size_t{1} << 16;
  void write_through(std::span<const std::byte> bytes);
  void flush();

  ScratchFile file_;
  std::vector<std::byte> pending_;
  std::uint64_t begin_ = 0;  // of the run under way
};

class RunReader {
 public:
  // window: bytes held of the run. file: outlives the reader.
  RunReader(const RunFile& file, RunExtent run, std::uint64_t window)
      : file_(&file), run_(run), window_(window) {}

  bool empty() const { return next_ == held_.size() && run_.begin == run_.end; }
  // Precondition: so many bytes are left.
  void read(std::span<std::byte> out) {
    if (out.empty()) return;
    if (out.size() > held_.size() - next_) return read_on(out);
    std::memcpy(out.data(), held_.data() + next_, out.size());
    next_ += out.size();
  }

 private:
  void read_on(std::span<std::byte> out);

  const RunFile* file_;
  RunExtent run_;  // what is not held yet
  std::uint64_t window_;
  std::vector<std::byte> held_;
  std::size_t next_ = 0;
};

}  // namespace voxweld
