// What TIFF tags and the descriptions ImageJ and OME writers leave say about a stack as a whole.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "storage/image/image_page.h"
#include "storage/types/box.h"

namespace voxweld {

struct StackCalibration {
  std::optional<Vec3> spacing;  // only where the file states all three axes
  std::string unit;             // of spacing: "mm", "um", "nm" ...; empty when it has none
  std::vector<std::string> warnings;
};

struct StackFileFacts {
  std::string path;       // for messages
  std::size_t pages = 0;  // of the file; 1 when each slice has a file of its own
};

// Throws FormatError when the description tells of channels or times beside z, or of images that
// the file has no page for (ImageJ's own form of files over 4 GiB).
StackCalibration read_calibration(const ImagePage& first, const StackFileFacts& facts);

}  // namespace voxweld
