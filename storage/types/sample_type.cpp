#include "storage/types/sample_type.h"

#include <algorithm>
#include <array>

namespace voxweld {
namespace {

// By position in enum SampleType; the first name of each is the canonical one.
constexpr std::array<std::array<std::string_view, 5>, 10> names = {{
    {"uint8", "u8", "uchar", "unsigned char", "uint8_t"},
    {"int8", "i8", "char", "signed char"},
    {"uint16", "u16", "ushort", "unsigned short", "uint16_t"},
    {"int16", "i16", "short", "int16_t"},
    {"uint32", "u32", "uint", "unsigned int", "uint32_t"},
    {"int32", "i32", "int", "int32_t"},
    {"uint64", "u64"},
    {"int64", "i64"},
    {"float32", "f32", "float"},
    {"float64", "f64", "double"},
}};

}  // namespace

std::size_t sample_bytes(SampleType type) {
  return dispatch_sample_type(type, [](auto tag) { return sizeof(typename decltype(tag)::type); });
}

std::string_view sample_type_name(SampleType type) {
  return names[static_cast<std::size_t>(type)][0];
}

std::optional<SampleType> parse_sample_type(std::string_view name) {
  for (std::size_t type = 0; type < names.size() && !name.empty(); ++type)
    if (std::ranges::find(names[type], name) != names[type].end())
      return static_cast<SampleType>(type);
  return std::nullopt;
}

}  // namespace voxweld
