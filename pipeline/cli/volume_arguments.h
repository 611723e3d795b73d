// Options that say how a volume is read, shared by the commands that open one.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/cli/commands.h"
#include "pipeline/info/value_scan.h"
#include "storage/readers/open_volume.h"

namespace voxweld {

struct VolumeArguments {
  std::string path, type, unit;
  std::string endian = "little";
  std::vector<std::int64_t> size;
  std::vector<double> spacing;  // none, one or three
  std::int64_t header_bytes = 0;
  bool follow = false;
  InputSelection select;
  std::string resample = "none";
};

void add_volume_options(CLI::App& command, VolumeArguments& arguments);

Resample resample_of(const VolumeArguments& arguments);

// InputError where they contradict each other. A stated size or type makes the format raw.
InputSpec input_spec(const VolumeArguments& arguments);

// Progress on the terminal's status line, and the interrupt.
ScanHooks scan_hooks(Program& program, const std::string& what);

}  // namespace voxweld
