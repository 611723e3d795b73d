// The one table of the keys of an [[edit]]: parsing and validation, help, schema and the commented
// files are made from it, as they are from the table of settings.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/settings.h"

namespace voxweld {

inline constexpr std::string_view edit_table = "edit";
inline constexpr std::array<SolidShape, 7> all_shapes = {
    SolidShape::sphere, SolidShape::box,   SolidShape::cylinder, SolidShape::cone,
    SolidShape::torus,  SolidShape::plane, SolidShape::mesh};
std::string_view shape_name(SolidShape shape);

// `required` is meant for the shapes that take the key and can not do without.
struct EditSetting : KeyFacts {
  std::vector<SolidShape> shapes;        // that take it; empty: all
  std::vector<SolidShape> optional_for;  // that take the default where it is `required`
  std::string sample;                    // a value as TOML, for examples

  // Precondition: check(rule, value) accepts.
  std::function<void(EditConfig&, const ConfigValue&)> set;
  std::function<ConfigValue(const EditConfig&)> get;
  // Null: an edit that takes the key always has a value for it.
  std::function<bool(const EditConfig&)> is_set;

  bool taken_by(SolidShape shape) const;
  bool required_by(SolidShape shape) const;
  std::string shapes_text() const;  // "cylinder, cone", or "all"
};

// In the order of keys in a config file.
std::span<const EditSetting> edit_settings();
// Null when there is none of that name.
const EditSetting* find_edit_setting(std::string_view key);
// Of all shapes, or those that one takes.
std::vector<std::string> edit_key_names(std::optional<SolidShape> shape = {});
// What edits are for, in one paragraph.
std::string_view edit_description();

// The keys the edit's shape takes, each with its value in its one canonical form, in table order.
struct EditValue {
  const EditSetting* setting = nullptr;
  ConfigValue value;
};
std::vector<EditValue> values_of(const EditConfig& edit);

}  // namespace voxweld
