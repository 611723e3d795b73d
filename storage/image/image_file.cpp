#include "storage/image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

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

// "II" or "MM", then 42 or, of BigTIFF, 43 in that byte order.
bool looks_tiff(const std::filesystem::path& path) {
  std::array<std::byte, 4> head{};
  const ReadFile file(path);
  if (file.size() < head.size()) return false;
  file.read(0, head);
  const auto at = [&](std::size_t i) { return std::to_integer<int>(head[i]); };
  const bool little = at(0) == 'I' && at(1) == 'I', big = at(0) == 'M' && at(1) == 'M';
  const int high = little ? at(3) : at(2), low = little ? at(2) : at(3);
  return (little || big) && high == 0 && (low == 42 || low == 43);
}

ImageService& service_of(const std::string& module, const std::string& purpose) {
  ImageService* images = load_module(module, purpose).images();
  if (images == nullptr)
    throw InputError(fmt::format(
        "the module {} has no images; install the module that came with this program", module));
  return *images;
}

}  // namespace

ImageService& image_service() {
  return service_of("image", "read and write images");
}

ImageService& tiff_service() {
  return service_of("tiff", "read TIFF files");
}

ImageFile::ImageFile(const std::filesystem::path& path, int level) : file_(describe_file(path)) {
  std::string error;
  ImageService& service = looks_tiff(file_.path) ? tiff_service() : image_service();
  reader_.reset(service.open(file_.path, level, error));
  if (!reader_)
    throw FormatError(
        fmt::format("{}: cannot be read as an image ({} bytes): {}; if it opens elsewhere, convert "
                    "it to an uncompressed TIFF of 8, 16 or 32 bits",
                    file_.path, file_.state.size, error));
  page_count_ = static_cast<std::size_t>(std::max(reader_->page_count(), 0));
  if (page_count_ == 0) throw FormatError(file_.path + ": no image found");
}

ImagePage ImageFile::page(std::size_t index) {
  ImagePage page;
  std::string error;
  if (!reader_->describe(static_cast<int>(index), page, error))
    throw FormatError(fmt::format("{}: page {}: {}", file_.path, index + 1, error));
  return page;
}

void ImageFile::read_rows(const ImageRows& rows, std::span<std::byte> out) {
  std::string error;
  if (!reader_->read_rows(rows, out.data(), error))
    throw FormatError(
        fmt::format("{}: rows {} to {} of page {} cannot be decoded: {}; the file is truncated or "
                    "damaged, copy "
                    "it from its source again",
                    file_.path, rows.y0, rows.y1 - 1, rows.page + 1, error));
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
