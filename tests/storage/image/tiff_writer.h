// A small TIFF writer for tests, independent of the library that reads: classic and BigTIFF, pages,
// strips, deflate, any sample format and the few tags that stacks carry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "storage/types/sample_type.h"

namespace voxweld::testing {

struct TiffPage {
  std::uint32_t width = 0, height = 0;
  SampleType type = SampleType::u8;
  std::uint16_t channels = 1;
  std::uint16_t bits = 0;         // bits a sample; 0: those of `type`
  std::uint16_t photometric = 1;  // 0 white is zero, 1 black is zero, 2 RGB
  std::uint16_t orientation = 0;  // 0: no tag
  std::uint32_t strip_rows = 0;   // 0: one strip
  bool deflate = false;
  bool lost_tail = false;  // the last strip lies beyond the end of the file
  std::string description;
  double resolution = 0;              // pixels a unit on both axes; 0: no tags
  std::uint16_t resolution_unit = 1;  // 1 none, 2 inch, 3 cm
  std::vector<std::byte> data;        // rows from the top, each starting at a byte
};

void write_tiff(const std::filesystem::path& path, const std::vector<TiffPage>& pages,
                bool big = false);

template <class T>
TiffPage tiff_page(std::uint32_t width, std::uint32_t height, SampleType type,
                   const std::vector<T>& samples) {
  TiffPage page;
  page.width = width;
  page.height = height;
  page.type = type;
  const auto* bytes = reinterpret_cast<const std::byte*>(samples.data());
  page.data.assign(bytes, bytes + samples.size() * sizeof(T));
  return page;
}

}  // namespace voxweld::testing
