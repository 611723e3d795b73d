// A config's volume in memory, with what it is to be contoured by.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "pipeline/config/config.h"
#include "tests/support/contour_in_memory.h"

namespace voxweld::paper {

struct ModelVolume {
  Config config;
  ContourParameters parameters;
  testing::MemoryVolume volume;
  bool empty = false;  // space that the edits alone fill

  ContourOptions options() const;
  HaloBlock block() const;
};

// overrides: "table.key=value". InputError and others as load_config() and the readers have them;
// the isovalue has to be a number.
ModelVolume load_model(const std::filesystem::path& config, std::span<const std::string> overrides);

}  // namespace voxweld::paper
