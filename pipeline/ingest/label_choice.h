// The labels a run meshes: the config's choice, its map, and what the volume has.
#pragma once

#include "pipeline/ingest/ingest_stage.h"
#include "stages/contouring/parameters.h"
#include "storage/labels/label_map.h"

namespace voxweld {

// labels.map; empty without one, or where labels are not meshed. Warns of what is not looked at.
// Throws what read_label_map does, and InputError where run.memory is not enough for it.
LabelMap read_labels_map(const Config& config);

// The rules as far as they are known without counting labels: sizes are not asked for.
LabelParameters chosen_labels(const Config& config, const LabelMap& map);

// The rules, once labels are counted. Where they are not, as while a part of the input cannot be
// read, chosen_labels. InputError where no label of the volume is left, or one is that no label may
// be.
LabelParameters final_labels(const Config& config, const LabelMap& map, const IngestJob& job);

}  // namespace voxweld
