#include "storage/image/image_file.h"

#include <fmt/format.h>

#include "storage/modules/module_loader.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr std::int64_t max_png_side = 1 << 20;

InputFile describe_file(const std::filesystem::path& path) {
  const ReadFile file(path);  // tells a missing or forbidden file from one that is no image
  return {file.path(), file.state()};
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
                    file_.path, file_.state.size, error));
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

void write_png(const std::filesystem::path& path, const PngImage& image,
               std::span<const std::byte> pixels) {
  const bool sane = image.width > 0 && image.height > 0 && image.width <= max_png_side &&
                    image.height <= max_png_side &&
                    (image.channels == 1 || image.channels == 3 || image.channels == 4);
  const std::int64_t expected = sane ? image.width * image.height * image.channels : 0;
  if (!sane || pixels.size() != static_cast<std::uint64_t>(expected))
    throw InputError(fmt::format(
        "{}: a PNG of {} x {} pixels and {} channels cannot be made of {} bytes; expected "
        "sides of 1 to {}, 1, 3 or 4 channels of one byte",
        path.string(), image.width, image.height, image.channels, pixels.size(), max_png_side));
  std::vector<unsigned char> encoded;
  std::string error;
  if (!image_service().encode_png(image, pixels, encoded, error))
    throw StorageError(fmt::format("cannot encode {}: {}", path.string(), error));
  write_whole_file(path, std::as_bytes(std::span(encoded)), Durability::fsync);
}

}  // namespace voxweld
