// Arrays of Zarr and N5 written by others, read in place, from a folder or a zip file.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// Opens the array in `directory`, as zarr_reader() does where nothing is chosen.
std::unique_ptr<SampleSource> open_zarr(const std::filesystem::path& directory);

// An array (the folder that holds zarr.json or .zarray), a group of OME-Zarr, or a group of arrays.
// Supported: any number of dimensions of which z, y and x (or y and x, as a volume of one slice) are
// read, and one channel and one time chosen; a regular grid, with or without sharding_indexed; the
// codecs that zarr_metadata.h lists. Missing chunks are fill value. info().files holds the metadata
// alone: an array may have millions of chunk files. Dimensions are taken by name where they have
// one. Throws InputError where there is no array or several, FormatError where something about it
// is not supported, naming it; reading throws FormatError for damaged chunks.
// Knows an array by its metadata, also what is refused then.
VolumeReader zarr_reader();

// The same of N5: an array is a folder with an attributes.json that says "dimensions", a pyramid one
// with arrays s0, s1 ... in it.
VolumeReader n5_reader();

}  // namespace voxweld
