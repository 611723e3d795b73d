#include "pipeline/config/load_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/refuse.h"
#include "pipeline/config/suggest.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Keys = std::vector<const DocumentEntry*>;

// One edit of a file: what its messages name it by, and its keys in the order they are written.
struct Written {
  const std::string& file;
  std::size_t number;  // from 1
  TextPlace header_at;
  Keys keys;

  const DocumentEntry* find(std::string_view key) const {
    const auto found = std::find_if(keys.begin(), keys.end(),
                                    [&](const DocumentEntry* entry) { return entry->key == key; });
    return found == keys.end() ? nullptr : *found;
  }
  [[noreturn]] void fail(TextPlace at, const std::string& problem) const {
    throw InputError(fmt::format("{}: edit {}: {}", place_text(file, at), number, problem));
  }
};

std::string what_it_takes(std::optional<SolidShape> shape) {
  return fmt::format("{} takes {}", shape ? fmt::format("A {}", shape_name(*shape)) : "An edit",
                     joined(edit_key_names(shape)));
}

// Empty where the shape is missing or wrong, which is told of later.
std::optional<SolidShape> shape_of(const Written& edit) {
  const EditSetting& setting = *find_edit_setting("shape");
  const DocumentEntry* entry = edit.find(setting.key);
  if (entry == nullptr || !check(setting.rule, entry->value).accepted) return std::nullopt;
  EditConfig config;
  setting.set(config, entry->value);
  return config.shape;
}

// Without a shape the keys of all are taken.
void read_key(const Written& edit, const DocumentEntry& entry, std::optional<SolidShape> shape,
              EditConfig& config) {
  const EditSetting* setting = find_edit_setting(entry.key);
  if (setting == nullptr) {
    const std::string nearest = nearest_name(entry.key, edit_key_names(shape));
    edit.fail(entry.key_at,
              fmt::format("unknown key {}{} {}", shown(entry.key),
                          nearest.empty() ? "." : did_you_mean(nearest), what_it_takes(shape)));
  }
  if (shape && !setting->taken_by(*shape))
    edit.fail(entry.key_at, fmt::format("a {} has no {}. {}", shape_name(*shape), setting->key,
                                        what_it_takes(shape)));
  require_accepted(place_text(edit.file, entry.value_at),
                   fmt::format("edit {}: {}", edit.number, setting->key), *setting, entry.value);
  ConfigValue value = entry.value;
  if (std::holds_alternative<PathRule>(setting->rule)) {
    const auto folder = std::filesystem::absolute(edit.file).parent_path();
    value = {(folder / *value.text()).lexically_normal().string()};
  }
  setting->set(config, value);
}

void check_required(const Written& edit, const EditConfig& config) {
  for (const EditSetting& setting : edit_settings())
    if (setting.required_by(config.shape) && edit.find(setting.key) == nullptr)
      edit.fail(edit.header_at, fmt::format("missing key {} (expected {}): {}", setting.key,
                                            accepted_text(setting.rule), setting.description));
}

void check_tube(const Written& edit, const EditConfig& config) {
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

void check_reach(const Written& edit) {
  for (const DocumentEntry* entry : edit.keys)
    if (entry->key != "axis" && is_far(entry->value))
      edit.fail(entry->value_at, fmt::format("{}: expected numbers up to {:g}, found {}",
                                             entry->key, farthest, to_toml(entry->value)));
}

}  // namespace

EditReader::EditReader(std::span<const DocumentEntry> entries, std::string file)
    : file_(std::move(file)) {
  for (const DocumentEntry& entry : entries)
    if (owns(entry) && entry.item > 0 && !entry.key.empty()) keys_[entry.item].push_back(&entry);
}

bool EditReader::owns(const DocumentEntry& entry) {
  return entry.table == edit_table || (entry.table.empty() && entry.key == edit_table);
}

void EditReader::read(const DocumentEntry& entry, std::vector<EditConfig>& edits) const {
  const std::string where = place_text(file_, entry.key_at);
  if (entry.table.empty()) {
    // The other way TOML has to write that there are none.
    if (entry.value.list() != nullptr && entry.value.list()->empty()) return;
    throw InputError(fmt::format("{}: expected tables [[edit]] with keys {}, found {}", where,
                                 joined(edit_key_names()), describe(entry.value)));
  }
  if (entry.item == 0)
    throw InputError(where +
                     ": found a single table [edit]; write [[edit]], which may stand any "
                     "number of times");
  if (!entry.key.empty()) return;
  const auto keys = keys_.find(entry.item);
  const Written written{file_, entry.item, entry.key_at,
                        keys == keys_.end() ? Keys{} : keys->second};
  EditConfig edit;
  const auto shape = shape_of(written);
  for (const DocumentEntry* key : written.keys) read_key(written, *key, shape, edit);
  check_required(written, edit);
  check_tube(written, edit);
  check_reach(written);
  edits.push_back(edit);
}

}  // namespace voxweld
