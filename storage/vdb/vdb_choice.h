// Which of the grids of a file is the volume.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "storage/types/volume_reader.h"
#include "storage/vdb/vdb_wire.h"

namespace voxweld {

// "'density' (float, fog volume, active box (0, 0, 0) to (9, 9, 9))".
std::string grid_text(const VdbGrid& grid);

// The index of the grid of input.dataset, else of the only one that can be read. Lists all in
// info.choices where there are several. InputError where several are left, none has that name, or
// the one is of another type than ours; FormatError where there is no grid.
std::size_t chosen_grid(std::span<const VdbGrid> grids, const InputSpec& spec, VolumeInfo& info);

}  // namespace voxweld
