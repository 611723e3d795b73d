// Samples as unsigned integers of the same order: comparing them is exact, total and the same on
// every vector unit. -0 is before 0. All NaNs are one, the largest.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace voxweld::filter_detail {

template <std::size_t bytes>
using KeyOfBytes = std::conditional_t<
    bytes == 1, std::uint8_t,
    std::conditional_t<bytes == 2, std::uint16_t,
                       std::conditional_t<bytes == 4, std::uint32_t, std::uint64_t>>>;
template <class T>
using Key = KeyOfBytes<sizeof(T)>;

template <class T>
Key<T> key_of(T v) {
  using K = Key<T>;
  constexpr K top = static_cast<K>(K{1} << (8 * sizeof(T) - 1));
  if constexpr (std::is_floating_point_v<T>) {
    const K bits = std::bit_cast<K>(v);
    const K key = (bits & top) != 0 ? static_cast<K>(~bits) : static_cast<K>(bits | top);
    return v == v ? key : std::numeric_limits<K>::max();
  } else if constexpr (std::is_signed_v<T>) {
    return static_cast<K>(static_cast<K>(v) ^ top);
  } else {
    return v;
  }
}

template <class T>
T value_of(Key<T> key) {
  using K = Key<T>;
  constexpr K top = static_cast<K>(K{1} << (8 * sizeof(T) - 1));
  if constexpr (std::is_floating_point_v<T>) {
    const K bits = (key & top) != 0 ? static_cast<K>(key ^ top) : static_cast<K>(~key);
    return key == std::numeric_limits<K>::max() ? std::numeric_limits<T>::quiet_NaN()
                                                : std::bit_cast<T>(bits);
  } else if constexpr (std::is_signed_v<T>) {
    return static_cast<T>(key ^ top);
  } else {
    return key;
  }
}

}  // namespace voxweld::filter_detail
