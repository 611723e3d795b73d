// Groups that hold an image at several resolutions: those of OME-Zarr, and of N5 by the customs of
// its viewers.
// Specification: "Next-generation file formats (NGFF)", versions 0.1 to 0.5: "multiscales" in the
// group's .zattrs, or in the attributes ("ome" of them) of its zarr.json.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "storage/store/byte_store.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {

struct Pyramid {
  struct Level {
    std::string path;  // of its array, in the group
    // Of each dimension, slowest first; empty: not said.
    std::vector<double> scale, translation;
    std::vector<std::string> units;
  };
  std::string where;  // the file that says so
  std::string name;
  std::vector<std::string> axes, types;  // of each dimension, slowest first; empty: not said
  std::vector<Level> levels;             // the finest first
  std::vector<std::string> channels;     // what they are called

  // What the level says of its array. Precondition: there is one.
  ArrayContext context(std::size_t level) const;
};

// The images of the group itself; none where it says of none. FormatError for what makes no sense.
std::vector<Pyramid> ome_pyramids_of(const StoreFolder& group);
// What a group at most four folders above says of the array; nothing where none does.
std::optional<ArrayContext> ome_context_of(const StoreFolder& array);

// The arrays s0, s1 ... in the group; nothing where there are none. Their sizes shrink by
// "downsamplingFactors" (or the group's "scales"); spacing is "pixelResolution", "resolution" or a
// "transform" of array or group.
std::optional<Pyramid> n5_pyramid_of(const StoreFolder& group);
// What an array's own attributes and those of the groups above say of it.
ArrayContext n5_context_of(const StoreFolder& array);

}  // namespace voxweld
