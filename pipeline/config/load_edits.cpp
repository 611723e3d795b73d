#include "pipeline/config/load_edits.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace voxweld {
namespace {

void check_tube(const WrittenItem& edit, const EditConfig& config) {
  if (config.tube <= config.radius || config.shape != SolidShape::torus) return;
  edit.fail(edit.find("tube")->value_at,
            fmt::format("tube = {}: expected at most radius = {}, so that the ring has a hole; "
                        "lower tube or raise radius",
                        to_toml({config.tube}), to_toml({config.radius})));
}

// Beyond any volume, and near enough that squares and sums of such numbers are exact to far less
// than a cell.
constexpr double farthest = 1e9;

bool is_far(const ConfigValue& value) {
  if (value.list() != nullptr)
    return std::any_of(value.list()->begin(), value.list()->end(), is_far);
  return value.is_number() && std::abs(value.number()) > farthest;
}

void check_reach(const WrittenItem& edit) {
  for (const DocumentEntry* entry : edit.keys)
    if (entry->key != "axis" && is_far(entry->value))
      edit.fail(entry->value_at, fmt::format("{}: expected numbers up to {:g}, found {}",
                                             entry->key, farthest, to_toml(entry->value)));
}

void check_edit(const WrittenItem& edit, const EditConfig& config) {
  check_tube(edit, config);
  check_reach(edit);
}

}  // namespace

ItemReader<EditConfig, SolidShape> edit_reader(std::span<const DocumentEntry> entries,
                                               std::string file) {
  return {edit_items(), entries, std::move(file), check_edit};
}

}  // namespace voxweld
