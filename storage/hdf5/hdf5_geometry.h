// Spacing, origin and unit as the conventions in use write them.
#pragma once

#include <string>
#include <vector>

#include "storage/hdf5/hdf5_axes.h"
#include "storage/hdf5/hdf5_file.h"

namespace voxweld {

// Names of the axes that NeXus gives the dimensions (attribute "axes" of the NXdata group around the
// dataset, or of the dataset), lower case; "." and what is not said are empty. Empty where there are
// none. FormatError where the first is an angle of rotation: projections are no volume.
std::vector<std::string> nexus_axes(const Hdf5File& file, hid_t dataset, const DatasetFacts& facts);

// Sets spacing, direction, origin and unit from, the first that is there: element_size_um; the axis
// datasets of NeXus, equally spaced; resolutions of axistags; resolution and offset as CREMI writes
// them. Else 1 with a warning. Preconditions: info.geometry.size is set.
// FormatError for axes of NeXus that are not equally spaced or in different units, unless the spec
// states a spacing.
void read_hdf5_geometry(const Hdf5File& file, hid_t dataset, const DatasetFacts& facts,
                        const VolumePlace& place, const InputSpec& spec, VolumeInfo& info);

}  // namespace voxweld
