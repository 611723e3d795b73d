#include "pipeline/report/png.h"

#include <png.h>

#include <stdexcept>

#include "pipeline/report/html_text.h"

namespace voxweld {

std::vector<std::byte> png_bytes(const Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = pixels.channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data.data(), 0, nullptr) ==
      0)
    throw std::runtime_error(std::string("libpng: ") + &image.message[0]);
  bytes.resize(size);
  return bytes;
}

std::string png_address(const Pixels& pixels) {
  return "data:image/png;base64," + base64(png_bytes(pixels));
}

}  // namespace voxweld
