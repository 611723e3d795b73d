// Arrays of N5: https://github.com/saalfeldlab/n5
#pragma once

#include <string>

#include "storage/store/zarr_metadata.h"

namespace voxweld {

// Whether attributes.json of that text is an array's.
bool is_n5_array(const std::string& text);
// From the text of an attributes.json. Missing blocks are 0. FormatError for types and compressions
// that are not supported, naming them.
ZarrArray parse_n5_array(const std::string& text, const std::filesystem::path& directory,
                         const ArrayContext& context = {});

}  // namespace voxweld
