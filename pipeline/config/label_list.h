// Labels, ranges of them and other integers beyond TOML's 63 bits as configs write them:
// [1, 5, "10-20", "18446744073709551614"].
#pragma once

#include <optional>
#include <vector>

#include "pipeline/config/rule.h"
#include "storage/types/label_range.h"

namespace voxweld {

// A label as an integer or as digits in quotes, or "first-last"; empty where it is neither.
std::optional<LabelRange> label_range_of(const ConfigValue& item);

// One label; empty where it is none or a range.
std::optional<std::uint64_t> label_of(const ConfigValue& item);
// An integer in quotes, as TOML has none so large; empty where it would need none.
std::optional<std::uint64_t> large_integer_of(const ConfigValue& item);
// In quotes only where it has to be.
ConfigValue integer_value(std::uint64_t integer);

// Ascending and apart: neighbours that touch are one range. Precondition: label_range_of takes
// every item.
std::vector<LabelRange> label_ranges_of(const ConfigValue::List& items);

// The one way to write them.
ConfigValue::List label_items(const std::vector<LabelRange>& ranges);

Verdict check_label(const ConfigValue& value);
Verdict check_label_list(const LabelListRule& rule, const ConfigValue& value);

}  // namespace voxweld
