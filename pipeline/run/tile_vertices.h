// How many vertices tiles have at most.
#pragma once

#include <cstdint>

#include "pipeline/stage/context.h"

namespace voxweld {

// The most vertices of a tile, where the config leaves that open: as many as are good to have in
// one file, halved until several such tiles can be encoded at once within run.memory.
std::int64_t fitting_tile_vertices(const Config& config);
// Gives output.tile_vertices this value where it is "auto", and merge's tiles what it would be without levels.
void fit_tiles(Config& config);
// Warns, before any work, where a tile of the config's output.tile_vertices could be too large.
void warn_of_large_tiles(const RunContext& context);

}  // namespace voxweld
