// Image files, page by page and row by row, in the samples' own type: no gamma, no colour
// conversion, no rescaling. The decoder is loaded on first use (image_service.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "storage/image/image_page.h"
#include "storage/image/image_service.h"
#include "storage/types/volume.h"

namespace voxweld {

// An image file opened for reading. Holds one file descriptor. One thread at a time.
class ImageFile {
 public:
  // Reads the headers of all pages. StorageError when the file cannot be opened, FormatError when
  // it is not an image that can be read.
  explicit ImageFile(const std::filesystem::path& path);

  const InputFile& file() const { return file_; }
  const std::string& path() const { return file_.path; }
  std::span<const ImagePage> pages() const { return pages_; }  // at least one

  // Fills `out` with rows [y0, y1) of a page: channels interleaved, x fastest, tightly packed,
  // native byte order. Rows asked for in rising order are decoded once.
  // Preconditions: 0 <= y0 < y1 <= height; out holds (y1 - y0) * width * channels samples.
  // FormatError when the file is truncated or damaged there.
  void read_rows(std::size_t page, std::int64_t y0, std::int64_t y1, std::span<std::byte> out);

 private:
  InputFile file_;
  std::unique_ptr<ImageModuleReader> reader_;
  std::vector<ImagePage> pages_;
};

// Writes `pixels` (rows from the top, channels interleaved, width * height * channels bytes) as a
// PNG, through a temporary name. InputError when the size does not fit, StorageError when writing
// fails.
void write_png(const std::filesystem::path& path, const PngImage& image,
               std::span<const std::byte> pixels);

}  // namespace voxweld
