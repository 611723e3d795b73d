// Texts of a report: escaped for HTML, and numbers as people read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "storage/types/box.h"

namespace voxweld {

// Safe between tags and in quoted attributes. What is no UTF-8 and no character that HTML allows
// becomes U+FFFD, so that the page stays valid whatever a path or a label's name holds.
std::string escaped(std::string_view text);

std::string base64(std::span<const std::byte> data);

std::string grouped(std::uint64_t number);  // "1,234,567"
// "1,234 edges", "1 edge".
std::string grouped(std::uint64_t count, const std::string& plural);
std::string short_number(double value);  // four digits that count: "0.1051", "12,345"
std::string with_unit(double value, const std::string& unit);
// "3 x 4 x 5 mm", with times signs.
std::string extent_text(Vec3 extent, const std::string& unit);
std::string extent_text(Index3 extent);

}  // namespace voxweld
