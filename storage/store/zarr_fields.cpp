#include "storage/store/zarr_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

#include "storage/support/refused_text.h"
#include "storage/support/small_float.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

constexpr std::int64_t largest_extent = std::int64_t{1} << 40;

template <class T>
using BitsOf = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

template <class T>
T parse_special_fill(const JsonField& field) {
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
T parse_whole_fill(const JsonField& field) {
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

// Of 16-bit floats; 4 digits of their bits.
float parse_half_fill(const JsonField& field) {
  if (field.value().is_number()) return static_cast<float>(field.real());
  const std::string text = field.text();
  unsigned bits = 0;
  const char *begin = text.data() + std::min<std::size_t>(2, text.size()),
             *end = text.data() + text.size();
  if (text.size() == 6 && text.starts_with("0x") &&
      std::from_chars(begin, end, bits, 16).ptr == end)
    return float_of_half(static_cast<std::uint16_t>(bits));
  return parse_special_fill<float>(field);
}

}  // namespace

nlohmann::ordered_json parse_zarr_document(const std::string& text, const std::string& file) {
  using Json = nlohmann::ordered_json;
  // Copying and printing a value recurse: a document made to be deep must not exhaust the stack.
  const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > 64) throw FormatError(file + ": nested more than 64 deep, which no zarr.json is");
    return true;
  };
  try {
    return Json::parse(text, check_depth);
  } catch (const nlohmann::json::exception& error) {
    throw FormatError(file + ": not valid JSON: " + json_problem(error));
  }
}

Extents zarr_extents(const JsonField& field, std::size_t rank) {
  const auto elements = field.elements();
  if (elements.size() != rank)
    field.refuse(fmt::format("{} extents expected, {} found", rank, field.shown()));
  Extents extents;
  for (const JsonField& element : elements) extents.push_back(element.integer(1, largest_extent));
  return extents;
}

std::vector<int> rows_first(std::size_t rank) {
  std::vector<int> dimensions(rank);
  std::iota(dimensions.begin(), dimensions.end(), 0);
  return dimensions;
}

std::vector<int> columns_first(std::size_t rank) {
  std::vector<int> dimensions = rows_first(rank);
  std::ranges::reverse(dimensions);
  return dimensions;
}

void check_zarr_size(const JsonField& field, const Extents& extents, std::size_t sample_bytes) {
  auto bytes = static_cast<std::int64_t>(sample_bytes);
  for (const std::int64_t extent : extents)
    if (__builtin_mul_overflow(bytes, extent, &bytes))
      field.refuse(field.shown() + " is more than 2^63 bytes");
}

void parse_fill_value(const JsonField& field, ZarrArray& array) {
  if (array.half) {
    const float value = parse_half_fill(field);
    std::memcpy(array.fill.data(), &value, sizeof value);
    return;
  }
  dispatch_sample_type(array.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    T value{};
    if constexpr (std::is_floating_point_v<T>)
      value =
          field.value().is_number() ? static_cast<T>(field.real()) : parse_special_fill<T>(field);
    else if (sizeof(T) == 1 && field.value().is_boolean())
      value = field.value().get<bool>() ? 1 : 0;
    else
      value = parse_whole_fill<T>(field);
    std::memcpy(array.fill.data(), &value, sizeof value);
  });
}

std::optional<VolumeGeometry> geometry_of(const ArrayContext& context, const ZarrArray& array) {
  if (context.scale.size() != array.axes.size()) return std::nullopt;
  VolumeGeometry geometry;
  geometry.size = array.size;
  std::optional<std::string> unit;
  for (std::size_t d = 0; d < array.axes.size(); ++d) {
    const int axis = array.axes[d];
    if (axis < 0) continue;
    geometry.spacing[axis] = context.scale[d];
    geometry.origin[axis] = context.translation.empty() ? 0 : context.translation[d];
    if (!std::isfinite(context.scale[d]) || !std::isfinite(geometry.origin[axis]))
      throw FormatError(
          fmt::format("{}: a scale of {} and a translation of {} of {}: numbers "
                      "expected",
                      context.where, context.scale[d], geometry.origin[axis], array.path.string()));
    const std::string own = d < context.units.size() ? canonical_unit(context.units[d]) : "";
    unit = !unit || *unit == own ? own : "";
  }
  geometry.unit = unit.value_or("");
  return geometry;
}

// A chunk is decoded whole. What fits this may still be over the caller's budget, who is told by
// largest_decode; what does not is no real array.
void check_zarr_chunk(const JsonField& root, const ZarrArray& array) {
  constexpr std::uint64_t most = std::uint64_t{1} << 40;
  if (array.form().bytes > most)
    root.refuse(
        fmt::format("one chunk takes {} bytes decoded, at most 2^40 are supported; rewrite "
                    "the array with smaller chunks",
                    array.form().bytes));
}

}  // namespace voxweld
