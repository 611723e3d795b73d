// A volume made of images: a directory or pattern of slices, or one multi-page file.
//
// Axes: x along a row, y down the rows of the file, z in slice order (first slice or page: z = 0;
// OME-TIFF: as its XML says; ImageJ: of one channel and time). Values are those of the file in its
// own type: odd bit depths are widened without rescaling, half floats become float32, white-is-zero
// images are turned so that brighter is larger, palette images in TIFF give their indices.
#pragma once

#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// spec.path: directory, file, or glob pattern ("scan/slice_*.tif"), or an OME companion (.ome). Of
// spec.select channel and time are looked at, level (resolutions in SubIFDs), and dataset (an image
// of an OME-TIFF, by name or number from 0). spec.spacing and spec.unit go
// before what the files say; the files' unit is not that of a spacing that is given.
// Reads the headers of all slices (one file open at a time) and checks that they fit together.
// The source has format "stack" and Access::slice; `read` takes boxes of whole rows, from one
// thread at a time, and decodes each row once when rows are asked for in rising order. ImageJ's
// files of one directory and many images are read in place (Access::box).
// Throws InputError when the path names no usable stack (missing slices, mixed names, nothing
// there), FormatError when a file is damaged or differs from the others, StorageError when the
// system fails.
std::unique_ptr<SampleSource> open_stack(const InputSpec& spec);

// Takes images, patterns and, since a folder of images is known by nothing else, every directory.
VolumeReader stack_reader();

}  // namespace voxweld
