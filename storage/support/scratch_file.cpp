#include "storage/support/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {

ScratchFile::ScratchFile(const std::filesystem::path& folder)
    : path_((folder / "scratch-XXXXXX").string()) {
  make_directories(folder);
  fd_ = mkostemp(path_.data(), O_CLOEXEC);
  if (fd_ < 0) throw_errno("create", path_, errno);
  unlink(path_.c_str());  // the system keeps it as long as it is open
}

ScratchFile::~ScratchFile() {
  close(fd_);
}

std::uint64_t ScratchFile::append(std::span<const std::byte> data) {
  write_at(fd_, size_, data, path_);
  return std::exchange(size_, size_ + data.size());
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (read_at(fd_, offset, out, path_) < out.size())
    throw StorageError("cannot read " + path_ + ": it ends early");
}

}  // namespace voxweld
