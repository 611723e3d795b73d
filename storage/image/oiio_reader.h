// Image files through OpenImageIO, for the module only. TIFF files are read by another module.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>
#include <vector>

#include "storage/image/image_service.h"

namespace voxweld {

class OiioReader final : public ImageModuleReader {
 public:
  // Null, and why in `error`, when the file is no image OpenImageIO can read.
  static std::unique_ptr<OiioReader> open(const std::string& path, std::string& error);

  int page_count() override;
  bool describe(int page, ImagePage& out, std::string& error) override;
  bool read_rows(const ImageRows& rows, std::byte* out, std::string& error) override;

 private:
  OiioReader(std::unique_ptr<OIIO::ImageInput> input, std::string path)
      : input_(std::move(input)), path_(std::move(path)) {}

  bool select(int page, std::string& error);
  bool read_tiled(const ImageRows& rows, std::byte* out);
  bool load_tile_row(std::int64_t tile_row);

  std::unique_ptr<OIIO::ImageInput> input_;
  std::string path_;
  int selected_ = -1;
  ImagePage page_;  // the selected one
  // The last tile row, decoded: bands that cut through it in order decode it once.
  std::vector<std::byte> tile_row_;
  std::int64_t tile_row_index_ = -1;
};

}  // namespace voxweld
