#include "storage/types/isovalue.h"

#include <fmt/format.h>

#include <cmath>

namespace voxweld {

std::string isovalue_text(const Isovalue& isovalue) {
  const double value = isovalue.value;
  // Digits where a reader would look for them: the shortest text of a large double is "1e+18".
  const bool whole = std::abs(value) <= 0x1p64 && value == std::floor(value);
  if (isovalue.rest == 0 && (!whole || std::abs(value) < 0x1p53)) return fmt::format("{}", value);
  const __int128 integer = isovalue.rest == 0 ? static_cast<__int128>(value) : isovalue.integer();
  return integer < 0 ? fmt::format("-{}", static_cast<std::uint64_t>(-integer))
                     : fmt::format("{}", static_cast<std::uint64_t>(integer));
}

}  // namespace voxweld
