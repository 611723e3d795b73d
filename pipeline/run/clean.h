// Work that no run of some configs would use: what earlier settings have left in the work
// directories.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/stage/context.h"

namespace voxweld {

struct CleanOptions {
  bool all = false;      // the configs' own work too
  bool dry_run = false;  // look only
};

struct CleanedPath {
  std::filesystem::path path;
  std::uint64_t bytes = 0;
};

// Of one work directory.
struct CleanReport {
  std::filesystem::path directory;
  std::vector<CleanedPath> removed;  // or would be; by name
  std::uint64_t kept = 0;            // folders of stages
  // Configs whose input is not ingested as it is now: which of the later stages' folders they would
  // use is not known, so those stay.
  std::vector<std::filesystem::path> unknown;

  std::uint64_t bytes() const;
};

// One report for each work directory, in the order of the configs. Touches only what voxweld has
// written, and nothing through links. Holds the lock of each output directory: waits for runs of
// these configs; InputError where another config's run writes there, or an input cannot be opened.
// Work of configs that are not among these is removed too.
std::vector<CleanReport> clean(std::span<const std::unique_ptr<RunContext>> configs,
                               const CleanOptions& options);

}  // namespace voxweld
