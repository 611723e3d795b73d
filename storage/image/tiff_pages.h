// The pages of a TIFF file, each presented as a file of its own.
//
// A TIFF's directories form a chain that libtiff walks from the start for every page asked for:
// 10,000 pages took two minutes to list and as long to read. So the chain is walked once, here, and
// a page is opened through a view of the file whose header points at its directory. A chain that
// leaves the file is an error here, where libtiff takes it for the end.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "storage/support/file_io.h"

namespace voxweld {

struct TiffDirectories {
  bool big = false;         // BigTIFF: 8-byte offsets
  bool big_endian = false;  // "MM"
  std::vector<std::uint64_t> offsets;
};

// Walks the chain. False with an empty error when the file is no TIFF; false and why when the chain
// is broken.
bool list_tiff_directories(const ReadFile& file, TiffDirectories& out, std::string& error);

// The file, with the first directory's offset in its header replaced by that of a chosen page.
class TiffPageView final : public OIIO::Filesystem::IOProxy {
 public:
  TiffPageView(const std::string& path, const TiffDirectories& directories);

  void choose(std::uint64_t directory_offset);

  const char* proxytype() const override { return "tiff page"; }
  std::size_t read(void* buffer, std::size_t size) override;
  std::size_t pread(void* buffer, std::size_t size, std::int64_t offset) override;
  std::size_t size() const override { return file_.size(); }

 private:
  ReadFile file_;
  bool big_, big_endian_;
  std::array<std::byte, 16> header_{};
  std::size_t header_bytes_;
};

}  // namespace voxweld
