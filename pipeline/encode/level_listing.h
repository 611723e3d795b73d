// The lists of coarser levels of detail at the end of encode: levels.jsonl, the tileset, and what the
// manifest says of levels.
#pragma once

#include "pipeline/encode/listing.h"
#include "pipeline/stage/level_meshes.h"
#include "pipeline/stage/stage_jobs.h"

namespace voxweld {

struct LevelListing {
  const EncodeJob& job;
  const LevelMeshes& levels;
  const Listing& tiles;  // of the mesh itself
};

// Memory that is taken for each leaf of the tree while levels are listed, about.
inline constexpr std::uint64_t listed_bytes = 160;

// The format whose files a tileset has for contents, by its name; empty: none of those that are written.
std::string tileset_format(const EncodeJob& job);

// Adds files and section to the manifest, whose counts are those of the mesh itself. leftovers: as
// write_listing has it.
void list_levels(const LevelListing& listing, Manifest& manifest, FileNames& leftovers);

}  // namespace voxweld
