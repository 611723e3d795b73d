// From [labels] of a config to the rules: which material each label stands for.
//
// Rules come in a normal form, so that equal rules are equal objects: ranges as large as can be; a
// label that becomes its own number is `own`; where the highest label there may be is own, others
// are true and no range is own, else others are false and every range is a material.
#pragma once

#include <functional>
#include <string>

#include "pipeline/config/config.h"
#include "storage/artifact/label_counts.h"
#include "storage/labels/label_map.h"
#include "storage/support/hash.h"
#include "storage/types/material.h"

namespace voxweld {

// What labels.select, labels.background and the map make of every label there may be. A label is
// left out where select does not take it, where the map leaves it out, and where it or what the map
// makes of it is of the background, less what select lists.
MaterialRules chosen_rules(const LabelsConfig& config, const LabelMap& map);

// Whether the rules depend on how many samples labels have.
bool asks_for_sizes(const LabelsConfig& config);

// Less the materials that have too few or too many samples. The rules are of this volume only: so
// that they are short, a label that is not in it stands for what its neighbours do.
// Memory: 32 bytes a range, at most as many as there are labels; InputError where that is more than
// `memory`.
MaterialRules sized_rules(const LabelsConfig& config, const MaterialRules& chosen,
                          const LabelCounts& counts, std::uint64_t memory);

// Calls f with each material that the volume has, ascending, until it returns false: its number in
// place of the label's, its samples and the box that holds them. Memory: 80 bytes for each range of
// the rules that is one material.
void each_material(const MaterialRules& rules, const LabelCounts& counts,
                   const std::function<bool(const LabelCount&)>& f);

// "3, 17 and 2 more": labels of the map that are left out as background though the map makes
// something else of them; empty where there are none. For a warning.
std::string background_in_map(const LabelsConfig& config, const LabelMap& map);

}  // namespace voxweld
