// What the modules that know images do for the program: "image" (OpenImageIO) for all formats but
// TIFF, and "tiff" (libtiff). A call that can fail returns false or null and says why in `error`
// (storage/modules/module_api.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/image/image_page.h"
#include "storage/image/ome_metadata.h"

namespace voxweld {

// One open image file. Calls come from one thread at a time.
class ImageModuleReader {
 public:
  virtual ~ImageModuleReader() = default;
  virtual int page_count() = 0;
  // Precondition: there is such a page.
  virtual bool describe(int page, ImagePage& out, std::string& error) = 0;
  // Tightly packed, in the page's sample type.
  virtual bool read_rows(const ImageRows& rows, std::byte* out, std::string& error) = 0;
};

struct PngImage {
  std::int64_t width = 0, height = 0;  // pixels, at least 1
  int channels = 3;                    // 1: grey, 3: RGB, 4: RGBA; eight bits each
};

class ImageService {
 public:
  virtual ~ImageService() = default;
  // Level 0: full resolution; others are those of ImagePage::levels.
  virtual ImageModuleReader* open(const std::string& path, int level, std::string& error) = 0;
  // Of the module "image".
  virtual bool encode_png(const PngImage& image, std::span<const std::byte> pixels,
                          std::vector<unsigned char>& out, std::string& error);
  // Of the module "tiff".
  virtual bool read_ome(const std::string& xml, OmeMetadata& out, std::string& error);
};

inline bool ImageService::encode_png(const PngImage& /*image*/, std::span<const std::byte>,
                                     std::vector<unsigned char>& /*out*/, std::string& error) {
  error = "this module writes no images";
  return false;
}

inline bool ImageService::read_ome(const std::string& /*xml*/, OmeMetadata& /*out*/,
                                   std::string& error) {
  error = "this module reads no XML";
  return false;
}

// Those of the modules, which the first call from any thread loads.
// InputError as of load_module() (storage/modules/module_loader.h).
ImageService& image_service();
ImageService& tiff_service();

}  // namespace voxweld
