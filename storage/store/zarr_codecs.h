// The codecs of an array: what Zarr 3 lists, and the compressors of Zarr 2 and N5 by their names.
#pragma once

#include <string>

#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {

// Sets chunk, shards, order and codecs. Precondition: axes, type and file are set. FormatError
// naming the codec that is not supported.
void parse_codecs(const JsonField& root, ZarrArray& array);

// A compressor as numcodecs describes it, by its "id". FormatError for others, and those that it has
// but voxweld has not.
Compressor parse_numcodecs_compressor(const JsonField& field, const std::string& id);

}  // namespace voxweld
