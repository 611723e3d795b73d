// The number samples are compared with. A double holds it but where it is an integer beyond 2^53;
// 64-bit integers are compared with that exactly.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace voxweld {

struct Isovalue {
  double value = 0;       // the nearest double
  std::int64_t rest = 0;  // what the integer has more than that; else 0

  constexpr Isovalue() = default;
  constexpr Isovalue(double number) : value(number) {}  // NOLINT: a double is an isovalue
  // Precondition: at most 2^64 + 1024 either way.
  template <class Integer>
  static constexpr Isovalue of(Integer integer) {
    Isovalue isovalue(static_cast<double>(integer));
    isovalue.rest = static_cast<std::int64_t>(static_cast<__int128>(integer) -
                                              static_cast<__int128>(isovalue.value));
    return isovalue;
  }

  // Precondition: rest is not 0.
  constexpr __int128 integer() const { return static_cast<__int128>(value) + rest; }

  // In the order of the numbers: rounding to doubles keeps it.
  friend constexpr auto operator<=>(const Isovalue&, const Isovalue&) = default;
};

// How one is chosen from a histogram.
enum class IsovalueRule : std::uint8_t { otsu, valley };
constexpr const char* isovalue_rule_name(IsovalueRule rule) {
  return rule == IsovalueRule::otsu ? "otsu" : "valley";
}

// "300", "0.5", "9007199254740993".
std::string isovalue_text(const Isovalue& isovalue);

}  // namespace voxweld
