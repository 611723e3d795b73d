// What the XML of an OME-TIFF says: which pages of which files make up which image.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace voxweld {

// One <TiffData>: pages one behind the other, in the image's order of planes.
struct OmePages {
  std::optional<std::int64_t> page{}, count{};  // IFD, PlaneCount
  std::int64_t z = 0, c = 0, t = 0;             // of the first plane
  std::string file{}, uuid{};                   // the file they are in; empty: not said
};

struct OmeImage {
  std::string id{}, name{};
  std::string order{};                             // DimensionOrder: "XYZCT" ...
  std::string type{};                              // Pixels Type: "uint8", "float" ...
  std::int64_t x = 0, y = 0, z = 0, c = 0, t = 0;  // sizes, at least 1
  std::array<std::string, 3> step{}, unit{};       // PhysicalSizeX and so on, as they stand there
  std::vector<std::string> channels{};             // names; those that have none are empty
  std::vector<OmePages> pages{};
};

struct OmeMetadata {
  std::string uuid{};           // of the file that holds the XML
  std::string metadata_file{};  // BinaryOnly: the file that holds all of it
  std::vector<OmeImage> images{};
};

}  // namespace voxweld
