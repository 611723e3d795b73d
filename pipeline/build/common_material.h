// What a range of label values says without a look at the samples.
#pragma once

#include <optional>

#include "storage/types/material.h"
#include "storage/types/volume.h"

namespace voxweld {

// The material that every value in the range is of, `exterior` where none of them is chosen;
// nothing where they may be of several. Values below zero are left out, as MaterialBlock has it.
std::optional<Material> common_material(const MaterialRules& rules, const ValueRange& range);

}  // namespace voxweld
