// The arrays and pyramids below a folder of a store.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "storage/store/foreign_array.h"
#include "storage/store/pyramid.h"

namespace voxweld {

// What a folder is by itself.
struct FolderContents {
  bool array = false;
  std::vector<Pyramid> pyramids;  // of which it is the group
};
FolderContents contents_of(const StoreFolder& folder, ArrayFamily family);

// Paths, from the folder, of those below that are arrays or groups of pyramids; arrays of a pyramid
// are left out. In the order of their names, as many as anybody would choose from.
std::vector<std::string> datasets_below(const StoreFolder& folder, ArrayFamily family);

}  // namespace voxweld
