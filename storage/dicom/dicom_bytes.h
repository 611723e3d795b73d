// The bytes of a DICOM file, from the file or, of a deflated one, from memory.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/support/file_io.h"

namespace voxweld {

class DicomBytes {
 public:
  explicit DicomBytes(const std::filesystem::path& path) : file_(path), size_(file_.size()) {}

  const std::string& path() const { return file_.path(); }
  const FileState& state() const { return file_.state(); }
  std::uint64_t size() const { return size_; }
  // FormatError when there are not so many.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  // From `begin` on the file is one raw deflate stream: offsets from there on are then those of its
  // contents. It is held in memory as a whole, at most 1032 times the file's size, which is what
  // deflate can make of one. FormatError where it is damaged.
  void inflate(std::uint64_t begin);
  // Bytes held in memory.
  std::uint64_t held() const { return inflated_.size(); }

 private:
  ReadFile file_;
  std::uint64_t size_;
  std::uint64_t inflated_begin_ = 0;
  std::vector<std::byte> inflated_;
};

// Reads small values one behind the other.
class DicomCursor {
 public:
  explicit DicomCursor(const DicomBytes& bytes) : bytes_(bytes) {}

  std::uint64_t at = 0;
  std::endian order = std::endian::little;

  const DicomBytes& bytes() const { return bytes_; }
  std::uint64_t size() const { return bytes_.size(); }
  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::string text(std::size_t length);
  // After the bytes themselves have changed.
  void forget() { block_.clear(); }

 private:
  template <class T>
  T number();
  // A view of the next `length` bytes, at most a block, and moves behind them.
  const std::byte* take(std::size_t length);

  const DicomBytes& bytes_;
  std::vector<std::byte> block_;
  std::uint64_t block_at_ = 0;
};

}  // namespace voxweld
