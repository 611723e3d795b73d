// Files of HDF5 whose layout is a format of its own: Imaris (.ims) and MINC 2 (.mnc).
#pragma once

#include <memory>
#include <optional>

#include "storage/hdf5/hdf5_axes.h"
#include "storage/hdf5/hdf5_file.h"

namespace voxweld {

// A dataset of a file and where in it the volume is. info: geometry with its size, scale, choices
// and warnings are set.
struct FoundVolume {
  Hdf5Handle dataset;
  DatasetFacts facts;
  VolumePlace place;
  VolumeInfo info;
};

// Nothing where the file has not that layout. Called under an Hdf5Lock. Errors as those of readers.

// Imaris 5.5: /DataSet/ResolutionLevel L/TimePoint T/Channel C/Data, slowest dimension z, filled up
// to whole chunks; the attributes ImageSizeX, Y, Z of the channel say what of it is image. ExtMin and
// ExtMax of /DataSetInfo/Image are the outer faces of the image, in Unit.
std::optional<FoundVolume> imaris_volume(const Hdf5File& file, const InputSpec& spec);

// MINC 2: /minc-2.0/image/0/image. Its attribute dimorder names the dimensions; start, step and
// direction_cosines of each say where its samples are, in a frame with x to the right, y to the
// front and z up. valid_range and image-min, image-max say what the stored integers stand for.
std::optional<FoundVolume> minc_volume(const Hdf5File& file, const InputSpec& spec);

}  // namespace voxweld
