// Turning samples of the other byte order into native ones, in place.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace voxweld {

namespace byte_order_detail {
inline std::uint16_t swapped(std::uint16_t v) {
  return __builtin_bswap16(v);
}
inline std::uint32_t swapped(std::uint32_t v) {
  return __builtin_bswap32(v);
}
inline std::uint64_t swapped(std::uint64_t v) {
  return __builtin_bswap64(v);
}
template <class T>
void swap_all(std::byte* data, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, data + i * sizeof(T), sizeof(T));
    value = swapped(value);
    std::memcpy(data + i * sizeof(T), &value, sizeof(T));
  }
}
}  // namespace byte_order_detail

// `count` values of `width` bytes (1, 2, 4 or 8) from `order` to native.
inline void to_native(std::byte* data, std::size_t count, std::size_t width, std::endian order) {
  if (order == std::endian::native) return;
  if (width == 2) byte_order_detail::swap_all<std::uint16_t>(data, count);
  if (width == 4) byte_order_detail::swap_all<std::uint32_t>(data, count);
  if (width == 8) byte_order_detail::swap_all<std::uint64_t>(data, count);
}

// One value of a binary header. Precondition: offset + sizeof(T) <= size of data.
template <class T>
T load_as(const std::byte* data, std::size_t offset, std::endian order) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, data + offset, sizeof(T));
  to_native(bytes, 1, sizeof(T), order);
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

}  // namespace voxweld
