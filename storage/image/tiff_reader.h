// TIFF files through libtiff, for the module only. Of a page one strip, one row of tiles, or some
// rows of an uncompressed strip are decoded and kept, so that rising rows are decoded once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "storage/image/image_service.h"
#include "storage/image/tiff_directories.h"
#include "storage/image/tiff_file.h"
#include "storage/image/tiff_samples.h"

namespace voxweld {

// How the samples of a page lie in its strips or tiles. A strip is a tile as wide as the page.
struct TiffLayout {
  TiffCoding coding;
  int compression = 1, photometric = 1;
  bool tiled = false;
  bool planar = false;         // each channel has strips or tiles of its own
  bool direct = false;         // stored as decoded: rows are read from the file
  bool reversed_bits = false;  // FillOrder 2
  std::uint32_t tile_width = 0, tile_height = 0;
  std::uint32_t across = 1, down = 1;                // tiles
  std::uint64_t tile_bytes = 0, tile_row_bytes = 0;  // decoded
};

class TiffReader final : public ImageModuleReader {
 public:
  // Null, and why in `error`, when the file is no TIFF that can be read.
  static std::unique_ptr<TiffReader> open(const std::string& path, int level, std::string& error);

  int page_count() override { return static_cast<int>(directories_.offsets.size()); }
  bool describe(int page, ImagePage& out, std::string& error) override;
  bool read_rows(const ImageRows& rows, std::byte* out, std::string& error) override;

 private:
  TiffReader(const std::string& path, int level, TiffDirectories directories)
      : level_(level), directories_(std::move(directories)), file_(path) {}

  void select(int page);
  void load_band(std::uint32_t plane, std::int64_t y);
  void load_direct(std::uint32_t plane, std::int64_t y);
  void copy_row(const ImageRows& rows, std::uint32_t channel, std::int64_t y, std::byte* out) const;

  int level_;
  TiffDirectories directories_;
  TiffFile file_;
  int selected_ = -1;
  ImagePage page_;  // the selected one
  TiffLayout layout_;
  // The rows [begin, end) that are decoded, as tiles beside each other.
  struct Band {
    std::vector<std::byte> bytes;
    std::uint32_t plane = 0;
    std::int64_t begin = 0, end = 0;
  } band_;
};

}  // namespace voxweld
