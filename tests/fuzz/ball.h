// The volume that every specimen of a format holds: a ball of 16-bit integers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "tests/support/deflated.h"

namespace voxweld::testing {

inline constexpr int size_x = 20, size_y = 18, size_z = 16;

inline std::int16_t value_at(int x, int y, int z) {
  const int square = (x - 9) * (x - 9) + (y - 9) * (y - 9) + (z - 8) * (z - 8);
  return static_cast<std::int16_t>(std::max(10, 230 - 4 * square));
}

// The samples of a box, x fastest, as T.
template <class T>
std::vector<T> samples(int z_begin = 0, int z_end = size_z, int y_begin = 0, int y_end = size_y,
                       int x_begin = 0, int x_end = size_x) {
  std::vector<T> all;
  for (int z = z_begin; z < z_end; ++z)
    for (int y = y_begin; y < y_end; ++y)
      for (int x = x_begin; x < x_end; ++x) all.push_back(static_cast<T>(value_at(x, y, z)));
  return all;
}

template <class T>
std::string as_string(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline std::string packed(const std::string& bytes, Wrapper wrapper = Wrapper::gzip) {
  const auto out = deflated(std::as_bytes(std::span(bytes)), wrapper);
  return {reinterpret_cast<const char*>(out.data()), out.size()};
}

inline std::string raw_samples() {
  return as_string(samples<std::int16_t>());
}

template <class T>
void put_at(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace voxweld::testing
