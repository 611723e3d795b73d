// Small pictures as PNG in memory. OpenImageIO writes files, and loading it takes longer than a
// whole report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace voxweld {

struct Pixels {
  int width = 0, height = 0;
  int channels = 1;                // 1: grey, 3: red, green, blue
  std::vector<std::uint8_t> data;  // rows from the top
};

// Precondition: width and height of at least 1, data as they say.
std::vector<std::byte> png_bytes(const Pixels& pixels);

// As the address of an image that is part of the page: "data:image/png;base64,...".
std::string png_address(const Pixels& pixels);

}  // namespace voxweld
