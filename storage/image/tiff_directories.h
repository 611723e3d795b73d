// Where the pages of a TIFF file are.
//
// A TIFF's directories form a chain that libtiff walks from the start for every page asked for:
// 10,000 pages took two minutes to list and as long to read. So the chain is walked once, here, and
// libtiff is handed the place of a page. A chain that leaves the file is an error here, where
// libtiff takes it for the end.
#pragma once

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

}  // namespace voxweld
