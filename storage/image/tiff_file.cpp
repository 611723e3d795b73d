#include "storage/image/tiff_file.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <stdexcept>

#include "storage/support/error.h"

namespace voxweld {
namespace {

// What libtiff may take at once for tables and the like, beyond what the file can fill.
constexpr std::uint64_t spare_memory = std::uint64_t{256} << 20;

std::string formatted(const char* format, va_list arguments) {
  std::array<char, 512> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  return text.data();
}

}  // namespace

int TiffFile::note_error(TIFF*, void* self, const char*, const char* format, va_list arguments) {
  std::string& error = static_cast<TiffFile*>(self)->error_;
  if (error.empty()) error = formatted(format, arguments);
  return 1;
}

int TiffFile::note_warning(TIFF*, void* self, const char*, const char* format, va_list arguments) {
  std::string& warning = static_cast<TiffFile*>(self)->warning_;
  if (warning.empty()) warning = formatted(format, arguments);
  return 1;
}

tmsize_t TiffFile::read_bytes(thandle_t self, void* out, tmsize_t size) {
  TiffFile& file = *static_cast<TiffFile*>(self);
  const std::uint64_t end = file.file_.size();
  if (size <= 0 || file.at_ >= end) return 0;
  const std::uint64_t count = std::min(static_cast<std::uint64_t>(size), end - file.at_);
  try {
    file.file_.read(file.at_, {static_cast<std::byte*>(out), static_cast<std::size_t>(count)});
  } catch (const std::exception& failure) {  // C code must not be unwound
    if (file.error_.empty()) file.error_ = failure.what();
    return -1;
  }
  file.at_ += count;
  return static_cast<tmsize_t>(count);
}

toff_t TiffFile::seek(thandle_t self, toff_t offset, int whence) {
  TiffFile& file = *static_cast<TiffFile*>(self);
  const std::uint64_t base = whence == SEEK_CUR   ? file.at_
                             : whence == SEEK_END ? file.file_.size()
                                                  : std::uint64_t{0};
  file.at_ = base + offset;
  return file.at_;
}

TiffFile::TiffFile(const std::string& path) : file_(path) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  if (options == nullptr) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, note_error, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options, note_warning, this);
  TIFFOpenOptionsSetMaxSingleMemAlloc(
      options,
      static_cast<tmsize_t>(spare_memory + 2 * std::min(file_.size(), std::uint64_t{1} << 60)));
  // h: reads no directory yet; m: maps nothing into memory; c: makes no small strips of large ones.
  tiff_ = TIFFClientOpenExt(
      path.c_str(), "rhmc", this, read_bytes,
      [](thandle_t, void*, tmsize_t) { return tmsize_t{0}; }, seek, [](thandle_t) { return 0; },
      [](thandle_t self) -> toff_t { return static_cast<TiffFile*>(self)->file_.size(); }, nullptr,
      nullptr, options);
  TIFFOpenOptionsFree(options);
  if (tiff_ == nullptr) fail();
}

TiffFile::~TiffFile() {
  if (tiff_ != nullptr) TIFFClose(tiff_);
}

void TiffFile::fail() const {
  throw FormatError(error_.empty() ? "libtiff gives no reason" : error_);
}

void TiffFile::go_to(std::uint64_t directory) {
  error_.clear();
  if (TIFFSetSubDirectory(tiff_, directory) == 0) fail();
}

void TiffFile::decode(std::uint32_t strile, bool tiled, bool warnings_count,
                      std::span<std::byte> out) {
  error_.clear();
  warning_.clear();
  const auto size = static_cast<tmsize_t>(out.size());
  const tmsize_t got = tiled ? TIFFReadEncodedTile(tiff_, strile, out.data(), size)
                             : TIFFReadEncodedStrip(tiff_, strile, out.data(), size);
  if (got != size) fail();
  if (warnings_count && !warning_.empty()) throw FormatError(warning_);
}

}  // namespace voxweld
