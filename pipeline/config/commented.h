// Config files written for people: one to begin with for a given volume, short or with every key,
// and one that shows every key there is. All load as they are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pipeline/config/config.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

enum class ConfigExtent : std::uint8_t {
  brief,  // the keys one is likely to change
  full    // all that the input may have, those at their defaults commented out
};

// What looking at the volume suggests.
struct InitSuggestion {
  std::string path;     // for input.path: absolute, or relative to where the config will lie
  bool labels = false;  // mesh them, instead of the surface at an isovalue
  double isovalue = 0;  // finite
  SurfaceConfig::Inside inside = SurfaceConfig::Inside::above;
  double lowest = 0, highest = 0;  // of the samples
  // Raw files only: what the user said of the layout besides size and type.
  InputConfig::Endian endian = InputConfig::Endian::little;
  std::int64_t header_bytes = 0;
  // Set where the file says nothing or something else.
  std::optional<Vec3> spacing;
  std::string unit;
  InputSelection select;  // as the user gave it
  Resample resample = Resample::none;
  bool follow = false;
};

// A config for that volume: facts about it in comments, and the keys one is likely to change. It
// means the same in both extents. The format is written only for raw files, which cannot be
// recognised. Precondition: suggestion.path is valid UTF-8 without control characters.
std::string commented_config(const VolumeInfo& info, const InitSuggestion& suggestion,
                             ConfigExtent extent);

// What looking at a mesh tells.
struct MeshSuggestion {
  std::string path;    // as that of InitSuggestion
  std::string format;  // "stl" ...
  std::uint64_t vertices = 0, triangles = 0;
  Vec3 lo, hi;              // of its box
  VolumeGeometry geometry;  // of the lattice that one of these gives
  std::optional<std::int64_t> resolution;
  std::optional<double> cell;
  MeshClosing close = MeshClosing::no;  // else it is open, or may be
  std::string unit;                     // of its coordinates; empty: not known
};

// The same for that mesh. Precondition: one of resolution and cell is set.
std::string commented_config(const MeshSuggestion& suggestion, ConfigExtent extent);

// Every key with its description, accepted values and default; input.path stands for a volume
// beside the config. configs/example.toml is this text.
std::string reference_config();

}  // namespace voxweld
