// What the image module (the only code that knows OpenImageIO) does for the program. A call that
// can fail returns false or null and says why in `error` (storage/modules/module_api.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/image/image_page.h"

namespace voxweld {

// One open image file. Calls come from one thread at a time.
class ImageModuleReader {
 public:
  virtual ~ImageModuleReader() = default;
  // False with an empty error: there is no such page.
  virtual bool describe(int page, ImagePage& out, std::string& error) = 0;
  // Rows [y0, y1) of a page, channels interleaved, tightly packed, in the page's sample type.
  virtual bool read_rows(int page, std::int64_t y0, std::int64_t y1, std::byte* out,
                         std::string& error) = 0;
};

struct PngImage {
  std::int64_t width = 0, height = 0;  // pixels, at least 1
  int channels = 3;                    // 1: grey, 3: RGB, 4: RGBA; eight bits each
};

class ImageService {
 public:
  virtual ~ImageService() = default;
  virtual ImageModuleReader* open(const std::string& path, std::string& error) = 0;
  virtual bool encode_png(const PngImage& image, std::span<const std::byte> pixels,
                          std::vector<unsigned char>& out, std::string& error) = 0;
};

// That of the module "image", which the first call from any thread loads.
// InputError as of load_module() (storage/modules/module_loader.h).
ImageService& image_service();

}  // namespace voxweld
