#include "storage/store/zarr_fields.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

#include "storage/support/refused_text.h"
#include "storage/support/text_fields.h"

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

std::vector<int> zarr_axes(const JsonField& shape, const std::vector<std::string>& names) {
  const std::size_t rank = shape.elements().size();
  if (rank != 2 && rank != 3)
    shape.refuse(fmt::format(
        "{} dimensions are not supported, 3 (z, y, x) expected; extract one volume first", rank));
  std::vector<int> axes, usual;
  bool spatial = names.size() == rank, other = false;
  for (std::size_t d = 0; d < rank; ++d) usual.push_back(static_cast<int>(rank - 1 - d));
  for (const std::string& name : names) {
    const std::string lower = voxweld::lower(name);
    const bool known = lower == "x" || lower == "y" || lower == "z";
    const int axis = known ? lower[0] - 'x' : 0;
    spatial = spatial && known && std::ranges::find(axes, axis) == axes.end() &&
              axis < static_cast<int>(rank);
    other = other || lower == "c" || lower == "t" || lower == "channel" || lower == "time";
    axes.push_back(axis);
  }
  if (spatial) return axes;
  if (other)
    shape.refuse(
        fmt::format("the dimensions are {}, of which not all are x, y and z: extract one "
                    "volume first",
                    fmt::join(names, ", ")));
  return usual;
}

Index3 zarr_extents(const JsonField& field, const std::vector<int>& axes) {
  const auto extents = field.elements();
  if (extents.size() != axes.size())
    field.refuse(fmt::format("{} extents expected, {} found", axes.size(), field.shown()));
  Index3 result = splat(1);
  for (std::size_t d = 0; d < axes.size(); ++d)
    result[axes[d]] = extents[d].integer(1, largest_extent);
  return result;
}

std::array<int, 3> order_of(const std::vector<int>& axes, const std::vector<int>& slowest_first) {
  std::array<int, 3> order{0, 1, 2};  // of two dimensions the third is z
  for (std::size_t i = 0; i < axes.size(); ++i)
    order[i] = axes[static_cast<std::size_t>(slowest_first[axes.size() - 1 - i])];
  return order;
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

void check_zarr_size(const JsonField& field, Index3 extents, SampleType type) {
  std::int64_t bytes = static_cast<std::int64_t>(sample_bytes(type));
  for (int axis = 0; axis < 3; ++axis)
    if (__builtin_mul_overflow(bytes, extents[axis], &bytes))
      field.refuse(field.shown() + " is more than 2^63 bytes");
}

std::array<std::byte, 8> zarr_fill_value(const JsonField& field, SampleType type) {
  std::array<std::byte, 8> fill{};
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    T value{};
    if constexpr (std::is_floating_point_v<T>)
      value =
          field.value().is_number() ? static_cast<T>(field.real()) : parse_special_fill<T>(field);
    else
      value = parse_whole_fill<T>(field);
    std::memcpy(fill.data(), &value, sizeof value);
  });
  return fill;
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
