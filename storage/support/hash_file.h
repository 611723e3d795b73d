// The content hash of a whole file, however large, a piece at a time.
#pragma once

#include <functional>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld {

// The hash that hash_bytes has of the same bytes. between: called before each piece, to stop.
// Errors as ReadFile::read has them.
Hash128 hash_file(const ReadFile& file, const std::function<void()>& between = {});

}  // namespace voxweld
