// The type of one sample. Inside/outside tests run in the sample's own type, so nothing is ever
// converted on the way from the file to the contouring.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace voxweld {

enum class SampleType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

std::size_t sample_bytes(SampleType type);
// "uint8", "int16", "float32" ...: the names of the config file, Zarr and numpy.
std::string_view sample_type_name(SampleType type);
// Also takes the common aliases (u8, uchar, short, float, double ...); empty when unknown.
std::optional<SampleType> parse_sample_type(std::string_view name);

template <class T>
struct SampleTag {
  using type = T;
};

// Calls f(SampleTag<T>{}) with the C++ type of the samples.
template <class F>
decltype(auto) dispatch_sample_type(SampleType type, F&& f) {
  switch (type) {
    case SampleType::u8:
      return std::forward<F>(f)(SampleTag<std::uint8_t>{});
    case SampleType::i8:
      return std::forward<F>(f)(SampleTag<std::int8_t>{});
    case SampleType::u16:
      return std::forward<F>(f)(SampleTag<std::uint16_t>{});
    case SampleType::i16:
      return std::forward<F>(f)(SampleTag<std::int16_t>{});
    case SampleType::u32:
      return std::forward<F>(f)(SampleTag<std::uint32_t>{});
    case SampleType::i32:
      return std::forward<F>(f)(SampleTag<std::int32_t>{});
    case SampleType::u64:
      return std::forward<F>(f)(SampleTag<std::uint64_t>{});
    case SampleType::i64:
      return std::forward<F>(f)(SampleTag<std::int64_t>{});
    case SampleType::f32:
      return std::forward<F>(f)(SampleTag<float>{});
    case SampleType::f64:
      break;
  }
  return std::forward<F>(f)(SampleTag<double>{});
}

}  // namespace voxweld
