// The JSON files of an export.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/neuroglancer/object_store.h"
#include "pipeline/neuroglancer/segments.h"

namespace voxweld {

// `segment_properties/info`: names, and numbers of triangles, volumes and areas where they are listed.
void write_segment_properties(const SegmentList& list, const Manifest& manifest,
                              const std::filesystem::path& folder);

struct InfoFacts {
  bool legacy = false;
  bool open_border = false;
  std::optional<Sharding> sharding;
};
// `info`, which makes the folder an export.
void write_info(const InfoFacts& facts, const VolumeGeometry& frame,
                const std::filesystem::path& folder);

}  // namespace voxweld
