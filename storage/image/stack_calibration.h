// What TIFF tags and the descriptions ImageJ and OME writers leave say about a stack as a whole.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/image/image_page.h"
#include "storage/image/ome_metadata.h"
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

// Of a page of ImageJ or a plain one.
StackCalibration read_calibration(const ImagePage& first, const StackFileFacts& facts);

// Of an image of an OME-TIFF.
StackCalibration ome_calibration(const OmeImage& image, const std::string& path);

// "key=value" of a line of ImageJ's description; empty when absent.
std::string_view imagej_value(std::string_view description, std::string_view key);

}  // namespace voxweld
