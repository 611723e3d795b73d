// Image files through OpenImageIO, for the module only.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>
#include <vector>

#include "storage/image/image_service.h"
#include "storage/image/tiff_pages.h"

namespace voxweld {

class OiioReader final : public ImageModuleReader {
 public:
  // Null, and why in `error`, when the file is no image OpenImageIO can read.
  static std::unique_ptr<OiioReader> open(const std::string& path, std::string& error);

  bool describe(int page, ImagePage& out, std::string& error) override;
  bool read_rows(int page, std::int64_t y0, std::int64_t y1, std::byte* out,
                 std::string& error) override;

 private:
  OiioReader(std::unique_ptr<OIIO::ImageInput> input, std::string path)
      : input_(std::move(input)), path_(std::move(path)) {}

  bool open_tiff(std::string& error);
  bool seek(int page, std::string& error);
  bool select(int page, std::string& error);
  bool read_tiled(std::int64_t y0, std::int64_t y1, std::byte* out);
  bool load_tile_row(std::int64_t tile_row);

  // TIFF only; outlives input_, which reads through it.
  TiffDirectories directories_;
  std::unique_ptr<TiffPageView> view_;
  std::unique_ptr<OIIO::ImageInput> input_;
  std::string path_;
  int selected_ = -1;
  ImagePage page_;  // the selected one
  // The last tile row, decoded: bands that cut through it in order decode it once.
  std::vector<std::byte> tile_row_;
  std::int64_t tile_row_index_ = -1;
};

}  // namespace voxweld
