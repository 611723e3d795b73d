#include <fmt/format.h>

#include "storage/image/image_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr std::int64_t max_png_side = 1 << 20;

}  // namespace

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
