// One volume in the formats of VTK.
#pragma once

#include <string>
#include <vector>

#include "storage/types/box.h"

namespace voxweld::testing {

struct SmallFile {
  std::string name;  // of the specimen
  std::string path, bytes;
};

// raw: the samples, int16, little-endian; text: the same as numbers.
std::vector<SmallFile> vtk_files(Index3 size, const std::string& raw, const std::string& text);

}  // namespace voxweld::testing
