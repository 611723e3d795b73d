// A file without a name, for what does not fit memory: it goes with the object, or the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace voxweld {

class ScratchFile {
 public:
  // In that folder, which is made where missing. StorageError where it cannot be written.
  explicit ScratchFile(const std::filesystem::path& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  std::uint64_t size() const { return size_; }
  // Returns the offset the data is at.
  std::uint64_t append(std::span<const std::byte> data);
  // Precondition: all of it was appended.
  void read(std::uint64_t offset, std::span<std::byte> out) const;

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace voxweld
