// Groups that hold an image at several resolutions, as OME-Zarr writes them.
// Specification: "Next-generation file formats (NGFF)", versions 0.1 to 0.5: "multiscales" in the
// group's .zattrs, or in the attributes ("ome" of them) of its zarr.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/store/zarr_metadata.h"

namespace voxweld {

// What the group says of one of its arrays. Of each dimension, slowest first; empty: not said.
struct OmeDataset {
  std::vector<std::string> axes, units;
  std::vector<double> scale, translation;
};

// Of an array that a group at most four folders above names; nothing where none does. FormatError
// for what a group says that makes no sense.
std::optional<OmeDataset> ome_dataset_of(const std::filesystem::path& array);
// The first array of the first image of a group; nothing where the directory is none with images.
std::optional<std::filesystem::path> full_resolution_of(const std::filesystem::path& group);
// The array in the directory, or of a group with images its full resolution, with what groups above
// say of it. Errors as read_zarr_array and the two above.
ZarrArray read_foreign_array(const std::filesystem::path& directory);
// Size as the array's; nothing where the group says no scale.
std::optional<VolumeGeometry> geometry_of(const OmeDataset& image, const ZarrArray& array);

}  // namespace voxweld
