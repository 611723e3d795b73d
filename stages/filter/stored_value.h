// One sample apart from its volume, whatever its type: the bits it is stored with.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "stages/contouring/inside_test.h"
#include "storage/types/isovalue.h"
#include "storage/types/sample_type.h"

namespace voxweld {

using StoredBits = std::uint64_t;  // those of the sample come first in memory, then zeros

template <class T>
StoredBits stored_bits(T value) {
  StoredBits bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  return bits;
}
template <class T>
T stored_value(StoredBits bits) {
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// The nearest sample of that type, of two the even one. Empty where the number lies beyond the type,
// or is none.
std::optional<StoredBits> nearest_stored(SampleType type, double number);
bool is_inside(SampleType type, StoredBits bits, const Isovalue& isovalue, Inside inside);
std::string stored_text(SampleType type, StoredBits bits);

// The least and the greatest of some samples, exact in any type. NaNs are left out.
struct StoredRange {
  bool empty = true;
  StoredBits least = 0, greatest = 0;
};
StoredRange merge(SampleType type, const StoredRange& a, const StoredRange& b);

}  // namespace voxweld
