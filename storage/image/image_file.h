// Image files, page by page and row by row, in the samples' own type: no gamma, no colour
// conversion, no rescaling. The decoder is loaded on first use (image_service.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "storage/image/image_page.h"
#include "storage/image/image_service.h"
#include "storage/types/volume.h"

namespace voxweld {

// An image file opened for reading. Holds one file descriptor. One thread at a time.
class ImageFile {
 public:
  // Lists the pages, of a TIFF without reading more of them than where they are. Level 0: full
  // resolution. StorageError when the file cannot be opened, FormatError when it is not an image
  // that can be read.
  explicit ImageFile(const std::filesystem::path& path, int level = 0);

  const InputFile& file() const { return file_; }
  const std::string& path() const { return file_.path; }
  std::size_t page_count() const { return page_count_; }  // at least one
  // FormatError when the page cannot be read. Precondition: there is such a page.
  ImagePage page(std::size_t index);

  // Fills `out` with the rows: x fastest, tightly packed, native byte order. Rows asked for in
  // rising order are decoded once.
  // Preconditions: 0 <= y0 < y1 <= height; there are such a page and channel; out holds the samples.
  // FormatError when the file is truncated or damaged there.
  void read_rows(const ImageRows& rows, std::span<std::byte> out);

 private:
  InputFile file_;
  std::unique_ptr<ImageModuleReader> reader_;
  std::size_t page_count_ = 0;
};

// Writes `pixels` (rows from the top, channels interleaved, width * height * channels bytes) as a
// PNG, through a temporary name. InputError when the size does not fit, StorageError when writing
// fails.
void write_png(const std::filesystem::path& path, const PngImage& image,
               std::span<const std::byte> pixels);

}  // namespace voxweld
