// The rows of the table of settings: what settings_*.cpp make them of. Internal to settings.cpp.
#pragma once

#include <initializer_list>
#include <limits>
#include <vector>

#include "pipeline/config/binding.h"
#include "pipeline/config/settings.h"

namespace voxweld::rows {

inline constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

using Stages = std::initializer_list<Stage>;
inline constexpr Stages none = {};
inline constexpr Stages ingest = {Stage::ingest};
inline constexpr Stages build = {Stage::build};
inline constexpr Stages merge = {Stage::merge};
inline constexpr Stages stitch = {Stage::stitch};
inline constexpr Stages levels = {Stage::levels};
inline constexpr Stages encode = {Stage::encode};
// What ingest lays out and build reads: the layout of raw samples (build reads them itself where
// there is no copy) and the shape of shards.
inline constexpr Stages ingest_and_build = {Stage::ingest, Stage::build};
// Merge goes on collapsing above the bricks by the rules of build. Root records need not change
// with them (a higher tolerance may leave every brick as it was), so merge's key names them too.
inline constexpr Stages collapse = {Stage::build, Stage::merge};
// Both passes over the stitched mesh.
inline constexpr Stages refined = {Stage::survey, Stage::refine, Stage::recount, Stage::seams};
// Build, as vertices leave their cells where there is such a pass.
inline constexpr Stages refined_from_build = {Stage::build, Stage::survey, Stage::refine,
                                              Stage::recount, Stage::seams};
// A survey is the same whatever is chosen by it.
inline constexpr Stages chosen = {Stage::refine, Stage::seams};
// What cells may be off, and edges.
inline constexpr Stages tolerance = {Stage::build,  Stage::merge,   Stage::survey,
                                     Stage::refine, Stage::recount, Stage::seams};
// Octrees and root records are relative to the cell, so their bytes need not change with the
// spacing; the lengths merge and stitch work with do. Samples are the same with any spacing: ingest
// writes no more than the store's metadata anew. Of a mesh, also where its lattice begins, which is
// in the files' coordinates.
inline constexpr Stages lengths = {Stage::build, Stage::merge, Stage::stitch};
// The open result is the closed one less some polygons, and those are made in stitch.
inline constexpr Stages border = {Stage::build, Stage::stitch};

struct SettingWords {
  const char* table;
  const char* key;
  const char* description;
  const char* default_note = "";
};

Setting row(SettingWords words, const binding::Binding<Config>& bound, Stages stages);
// The same without a default: whoever writes a config has to say.
Setting required(Setting setting);
// Keyed by what the value comes to (Setting::by_effect).
Setting by_effect(Setting setting);
// In no key where it is open (Setting::when_given).
Setting when_given(Setting setting);

// Table by table.
std::vector<Setting> input_settings();
std::vector<Setting> work_settings();
std::vector<Setting> surface_settings();
std::vector<Setting> labels_settings();
std::vector<Setting> simplify_settings();
std::vector<Setting> output_settings();
std::vector<Setting> run_settings();
std::vector<Setting> slurm_settings();

}  // namespace voxweld::rows
