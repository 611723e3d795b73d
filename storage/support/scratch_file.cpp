#include "storage/support/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

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
  std::size_t done = 0;
  while (done < data.size()) {
    const ssize_t put =
        pwrite(fd_, data.data() + done, data.size() - done, static_cast<off_t>(size_ + done));
    if (put < 0) {
      if (errno == EINTR) continue;
      throw_errno("write", path_, errno);
    }
    done += static_cast<std::size_t>(put);
  }
  const std::uint64_t offset = size_;
  size_ += data.size();
  return offset;
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got =
        pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0) {
      if (errno == EINTR) continue;
      throw_errno("read", path_, errno);
    }
    if (got == 0) throw StorageError("cannot read " + path_ + ": it ends early");
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace voxweld
