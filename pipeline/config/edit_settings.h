// The one table of the keys of an [[edit]].
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/item_settings.h"

namespace voxweld {

inline constexpr std::string_view edit_table = "edit";
inline constexpr std::array<SolidShape, 7> all_shapes = {
    SolidShape::sphere, SolidShape::box,   SolidShape::cylinder, SolidShape::cone,
    SolidShape::torus,  SolidShape::plane, SolidShape::mesh};
std::string_view shape_name(SolidShape shape);

using EditSetting = ItemSetting<EditConfig, SolidShape>;
using EditTable = ItemTable<EditConfig, SolidShape>;
using EditValue = EditTable::Value;

const EditTable& edit_items();

// Parts of that table.
std::span<const EditSetting> edit_settings();
const EditSetting* find_edit_setting(std::string_view key);
std::vector<std::string> edit_key_names(std::optional<SolidShape> shape = {});
std::vector<EditValue> values_of(const EditConfig& edit);

}  // namespace voxweld
