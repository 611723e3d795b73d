#include "storage/types/sample_type.h"

#include <array>

namespace voxweld {
namespace {

struct Alias {
  std::string_view name;
  SampleType type;
};
// The first name of each type is the canonical one.
constexpr std::array<Alias, 37> aliases = {{
    {"uint8", SampleType::u8},
    {"int8", SampleType::i8},
    {"uint16", SampleType::u16},
    {"int16", SampleType::i16},
    {"uint32", SampleType::u32},
    {"int32", SampleType::i32},
    {"uint64", SampleType::u64},
    {"int64", SampleType::i64},
    {"float32", SampleType::f32},
    {"float64", SampleType::f64},
    {"u8", SampleType::u8},
    {"i8", SampleType::i8},
    {"u16", SampleType::u16},
    {"i16", SampleType::i16},
    {"u32", SampleType::u32},
    {"i32", SampleType::i32},
    {"u64", SampleType::u64},
    {"i64", SampleType::i64},
    {"f32", SampleType::f32},
    {"f64", SampleType::f64},
    {"uchar", SampleType::u8},
    {"unsigned char", SampleType::u8},
    {"uint8_t", SampleType::u8},
    {"signed char", SampleType::i8},
    {"char", SampleType::i8},
    {"ushort", SampleType::u16},
    {"unsigned short", SampleType::u16},
    {"uint16_t", SampleType::u16},
    {"short", SampleType::i16},
    {"int16_t", SampleType::i16},
    {"uint", SampleType::u32},
    {"unsigned int", SampleType::u32},
    {"uint32_t", SampleType::u32},
    {"int", SampleType::i32},
    {"int32_t", SampleType::i32},
    {"float", SampleType::f32},
    {"double", SampleType::f64},
}};

}  // namespace

std::size_t sample_bytes(SampleType type) {
  return dispatch_sample_type(type, [](auto tag) { return sizeof(typename decltype(tag)::type); });
}

std::string_view sample_type_name(SampleType type) {
  return aliases[static_cast<std::size_t>(type)].name;
}

std::optional<SampleType> parse_sample_type(std::string_view name) {
  for (const Alias& alias : aliases)
    if (alias.name == name) return alias.type;
  return std::nullopt;
}

}  // namespace voxweld
