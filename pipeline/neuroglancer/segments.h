// Which objects an export has, and how large the fragments of each are.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/manifest/manifest.h"

namespace voxweld {

struct Segment {
  std::uint64_t id = 1;
  std::string name;
  std::int32_t chunk = 65535;  // the side of a fragment at level 0, one of fragment_chunks
  std::uint64_t triangles = 0;
  std::optional<double> volume, area;  // as labels.jsonl has them
};

struct SegmentList {
  std::vector<Segment> segments;  // by id
  bool labels = false;            // each is a label's, else there is one
  bool left_out_zero = false;     // label 0 has a mesh, and Neuroglancer takes no segment 0

  // The place of what a tile's triangles belong to; nothing where it is left out.
  std::optional<std::size_t> find(Material label) const;
};

// Of a finished output directory. Fragments are the largest that are expected to have no more triangles
// than this. InputError where there is nothing to export.
SegmentList read_segments(const std::filesystem::path& output, const Manifest& manifest,
                          std::uint64_t fragment_triangles);

}  // namespace voxweld
