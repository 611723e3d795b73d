// Checked file access: all that is asked, or an error that names the path (error.h says which).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/types/file_state.h"

namespace voxweld {

// At an offset of an open file: as many bytes as there are, and all of these. path: for messages.
std::size_t read_at(int file, std::uint64_t offset, std::span<std::byte> out,
                    const std::string& path);
void write_at(int file, std::uint64_t offset, std::span<const std::byte> data,
              const std::string& path);

// Nothing where there is no such file.
std::optional<FileState> file_state(const std::filesystem::path& path);

// A file opened for reading; pread-based, so one object serves many threads.
class ReadFile {
 public:
  explicit ReadFile(const std::filesystem::path& path);
  ~ReadFile();
  ReadFile(ReadFile&& other) noexcept;
  ReadFile& operator=(ReadFile&& other) noexcept;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return state_.size; }
  // When it was opened.
  const FileState& state() const { return state_; }
  // Reads exactly out.size() bytes at offset; FormatError "truncated" when the file ends before.
  void read(std::uint64_t offset, std::span<std::byte> out) const;

 private:
  std::string path_;
  int fd_ = -1;
  FileState state_;
};

enum class Durability {
  rename_only,  // intermediates: power loss is caught by their checksums
  fsync,        // outputs
};

// A name of its own beside `path`, that says which process of which host has made it.
std::string temporary_name(const std::filesystem::path& path);

// Writes `path` through a temporary name in the same directory, creating
// the directory where missing. Nothing appears under the final name before commit(); a destructor
// without commit removes the temporary. Appends are buffered.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::uint64_t size() const { return size_; }  // bytes so far
  void append(std::span<const std::byte> data);
  // Within the size. From many threads at once, where nothing is appended meanwhile.
  void write_at(std::uint64_t offset, std::span<const std::byte> data);
  void extend(std::uint64_t size);  // with zeros, to that size; it may not be smaller
  void commit(Durability durability);

 private:
  void flush();

  std::filesystem::path final_path_;
  std::string temporary_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::vector<std::byte> buffer_;
};

// Removes the temporaries in `folder` (and below it, where `recursive`) that processes of this host
// left behind when they were killed: those whose process is no more. Others' stay.
void remove_stale_temporaries(const std::filesystem::path& folder, bool recursive);
// The same of all temporaries whose files are in place: whoever is still at it, on whatever host,
// does what is done. To be called when a folder's files are complete.
void remove_needless_temporaries(const std::filesystem::path& folder, bool recursive);

std::vector<std::byte> read_whole_file(const std::filesystem::path& path);
std::string read_text_file(const std::filesystem::path& path);
void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> data,
                      Durability durability);
inline std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}
void make_directories(const std::filesystem::path& path);
void remove_file(const std::filesystem::path& path);  // where it is there

}  // namespace voxweld
