// Zarr v3 arrays written by others, read in place.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// Opens the array in `directory` (the one that holds zarr.json) as a source with Access::box.
// Supported: three dimensions z, y, x, or two as a volume of one slice; a regular grid, with or
// without sharding_indexed; bytes of either order, blosc, zstd, gzip, crc32c. Missing chunks are
// fill value. info().files holds zarr.json alone: an array may have millions of chunk files.
// Throws InputError where there is no array, FormatError where something about it is not
// supported, naming it; reading throws FormatError for damaged chunks.
std::unique_ptr<SampleSource> open_zarr(const std::filesystem::path& directory);

// Knows an array by its metadata, also what is refused then: groups and arrays of version 2.
VolumeReader zarr_reader();

}  // namespace voxweld
