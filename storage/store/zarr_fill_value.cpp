#include "storage/store/zarr_fill_value.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace voxweld {
namespace {

template <class T>
using BitsOf = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

template <class T>
T parse_special(const JsonField& field) {
  const std::string text = field.text();
  if (text == "NaN") return std::numeric_limits<T>::quiet_NaN();
  if (text == "Infinity") return std::numeric_limits<T>::infinity();
  if (text == "-Infinity") return -std::numeric_limits<T>::infinity();
  if (text.size() == 2 + 2 * sizeof(T) && text.starts_with("0x")) {
    BitsOf<T> bits = 0;
    const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), bits, 16);
    if (error == std::errc() && end == text.data() + text.size()) return std::bit_cast<T>(bits);
  }
  field.refuse(fmt::format(
      "a number, \"NaN\", \"Infinity\", \"-Infinity\" or \"0x\" and {} digits expected, {} found",
      2 * sizeof(T), field.shown()));
}

template <class T>
T parse_integer(const JsonField& field) {
  const auto& value = field.value();
  const auto wrong = [&] {
    field.refuse(fmt::format("an integer from {} to {} expected, {} found",
                             std::numeric_limits<T>::min(), std::numeric_limits<T>::max(),
                             field.shown()));
  };
  if (value.is_number_unsigned()) {
    const auto v = value.get<std::uint64_t>();
    if (v > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) wrong();
    return static_cast<T>(v);
  }
  if (!value.is_number_integer()) wrong();
  const auto v = value.get<std::int64_t>();  // negative: others are unsigned
  if (std::is_unsigned_v<T> ? v < 0 : v < static_cast<std::int64_t>(std::numeric_limits<T>::min()))
    wrong();
  return static_cast<T>(v);
}

}  // namespace

std::array<std::byte, 8> parse_fill_value(const JsonField& field, SampleType type) {
  std::array<std::byte, 8> fill{};
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    T value{};
    if constexpr (std::is_floating_point_v<T>)
      value = field.value().is_number() ? static_cast<T>(field.real()) : parse_special<T>(field);
    else
      value = parse_integer<T>(field);
    std::memcpy(fill.data(), &value, sizeof value);
  });
  return fill;
}

}  // namespace voxweld
