// An open TIFF file of libtiff's, whose errors throw. For the module only.
#pragma once

#include <tiffio.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "storage/support/file_io.h"

namespace voxweld {

class TiffFile {
 public:
  explicit TiffFile(const std::string& path);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  TIFF* get() const { return tiff_; }
  const ReadFile& bytes() const { return file_; }

  // Makes the directory at that offset the current one.
  void go_to(std::uint64_t directory);
  // Decodes a strip or tile. Short data is an error; of codecs that make up what they miss and warn
  // (JPEG, fax), warnings are too.
  void decode(std::uint32_t strile, bool tiled, bool warnings_count, std::span<std::byte> out);

  // Tags with one value: what the file says, else what the format says, else `otherwise`.
  template <class T>
  T tag(std::uint32_t name, T otherwise) const {
    T value = otherwise;
    if (TIFFGetFieldDefaulted(tiff_, name, &value) != 1) value = otherwise;
    return value;
  }

 private:
  [[noreturn]] void fail() const;

  static int note_error(TIFF*, void* self, const char*, const char* format, va_list arguments);
  static int note_warning(TIFF*, void* self, const char*, const char* format, va_list arguments);
  static tmsize_t read_bytes(thandle_t self, void* out, tmsize_t size);
  static toff_t seek(thandle_t self, toff_t offset, int whence);

  ReadFile file_;
  std::uint64_t at_ = 0;
  std::string error_, warning_;  // the first since the last call
  TIFF* tiff_ = nullptr;
};

}  // namespace voxweld
