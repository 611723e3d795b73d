// "Did you mean": the known name nearest to a mistyped one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace voxweld {

// The nearest of `known` by edit distance (insert, delete, replace, swap of neighbours), the first
// of equals; empty when none is near enough to be a slip of the keyboard.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace voxweld
