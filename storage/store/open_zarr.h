// Zarr arrays written by others, read in place.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// Opens the array in `directory` (the one that holds zarr.json or .zarray) as a source with
// Access::box. Supported: three dimensions z, y, x, or two as a volume of one slice, in any order
// within chunks; a regular grid, with or without sharding_indexed; bytes of either order, and the
// compressors that zarr_metadata.h lists. Missing chunks are fill value. info().files holds the
// metadata alone: an array may have millions of chunk files. Of a group of OME-Zarr the full
// resolution of its first image is opened. Dimensions are taken by name where they have one.
// Throws InputError where there is no array, FormatError where something about it is not
// supported, naming it; reading throws FormatError for damaged chunks.
std::unique_ptr<SampleSource> open_zarr(const std::filesystem::path& directory);

// Knows an array by its metadata, also what is refused then: groups without images.
VolumeReader zarr_reader();

}  // namespace voxweld
