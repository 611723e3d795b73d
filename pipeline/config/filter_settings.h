// The one table of the keys of a [[filter]].
#pragma once

#include <string_view>

#include "pipeline/config/item_settings.h"

namespace voxweld {

inline constexpr std::string_view filter_table = "filter";

using FilterSetting = ItemSetting<FilterConfig, FilterType>;
using FilterTable = ItemTable<FilterConfig, FilterType>;

const FilterTable& filter_items();

// A median is of a sorted list of all samples around: it takes smaller ones than a mean does.
inline constexpr std::int64_t most_median_radius = 10;

}  // namespace voxweld
