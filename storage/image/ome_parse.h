// Reads OME-XML, for the module only.
#pragma once

#include <string>

#include "storage/image/ome_metadata.h"

namespace voxweld {

// False, and why in `error`, where the text is no XML or lacks what an image needs. Sizes are at
// least 1 and below 2^31, other numbers at least 0.
bool parse_ome(const std::string& xml, OmeMetadata& out, std::string& error);

}  // namespace voxweld
