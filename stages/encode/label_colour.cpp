#include "stages/encode/label_colour.h"

#include <algorithm>
#include <cmath>

namespace voxweld {

std::array<double, 3> label_colour(Material label) {
  // Below a prime, so that the product keeps its fraction.
  const double turns = static_cast<double>(label % 1000003) * 0.6180339887498949;
  const double hue = 6 * (turns - std::floor(turns));
  std::array<double, 3> colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double place = std::fmod(hue + (i == 0 ? 0.0 : i == 1 ? 4.0 : 2.0), 6.0);
    const double level = std::clamp(std::abs(place - 3) - 1, 0.0, 1.0);
    colour[i] = std::round((0.25 + 0.6 * level) * 1000) / 1000;
  }
  return colour;
}

std::optional<std::array<double, 3>> given_colour(const MaterialTable& table, Material label) {
  const MaterialEntry* entry = table.find(label);
  if (entry == nullptr || !entry->color) return std::nullopt;
  // IEC 61966-2-1.
  const auto linear = [](std::uint8_t value) {
    const double v = value / 255.0;
    const double level = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    return std::round(level * 1e5) / 1e5;
  };
  return std::array{linear(entry->color->red), linear(entry->color->green),
                    linear(entry->color->blue)};
}

}  // namespace voxweld
