#include "storage/image/image_file.h"

#include <fmt/format.h>

#include "storage/modules/module_loader.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

InputFile describe_file(const std::filesystem::path& path) {
  const ReadFile file(path);  // tells a missing or forbidden file from one that is no image
  return {file.path(), file.size(), file.mtime_ns()};
}

}  // namespace

ImageService& image_service() {
  ImageService* images = load_module("image", "read and write images").images();
  if (images == nullptr)
    throw InputError(
        "the module image has no images; install the module that came with this program");
  return *images;
}

ImageFile::ImageFile(const std::filesystem::path& path) : file_(describe_file(path)) {
  std::string error;
  reader_.reset(image_service().open(file_.path, error));
  if (!reader_)
    throw FormatError(
        fmt::format("{}: cannot be read as an image ({} bytes): {}; if it opens elsewhere, convert "
                    "it to an uncompressed TIFF of 8, 16 or 32 bits",
                    file_.path, file_.size, error));
  ImagePage page;
  while (reader_->describe(static_cast<int>(pages_.size()), page, error)) pages_.push_back(page);
  if (!error.empty() || pages_.empty())
    throw FormatError(fmt::format("{}: page {}: {}", file_.path, pages_.size() + 1,
                                  error.empty() ? "no image found" : error));
}

void ImageFile::read_rows(std::size_t page, std::int64_t y0, std::int64_t y1,
                          std::span<std::byte> out) {
  std::string error;
  if (!reader_->read_rows(static_cast<int>(page), y0, y1, out.data(), error))
    throw FormatError(
        fmt::format("{}: rows {} to {} of page {} cannot be decoded: {}; the file is truncated or "
                    "damaged, copy "
                    "it from its source again",
                    file_.path, y0, y1 - 1, page + 1, error));
}

}  // namespace voxweld
