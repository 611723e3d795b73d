// The benchmark volumes `voxweld phantom` makes: their names, and how a field value becomes a
// sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "storage/types/sample_type.h"

namespace voxweld {

enum class PhantomKind : std::uint8_t {
  sphere,
  torus,
  gyroid,
  part,
  temple,
  labels,
  junctions,
  porous,
  noise
};

struct PhantomKindInfo {
  PhantomKind kind;
  std::string_view name;
  std::string_view summary;  // one line, for help texts
};

// All kinds, in the order of help texts.
std::span<const PhantomKindInfo> phantom_kinds();
std::string_view phantom_kind_name(PhantomKind kind);
// InputError naming the known kinds when there is no such one.
PhantomKind parse_phantom_kind(std::string_view name);

// Whether its values are labels, numbers from 0 on that stay as they are.
bool holds_labels(PhantomKind kind);
// The highest of them.
std::uint64_t phantom_labels(PhantomKind kind);

// Label k as a sample: 0 is 0, the others count from `first` on.
template <class T>
T label_sample(double k, std::uint64_t first) {
  return k == 0 ? T{0} : static_cast<T>(first + static_cast<std::uint64_t>(k) - 1);
}

// sample = floor(offset + gain d) clamped to the type's range for integer types, gain d for float
// (offset 0). Labels take offset 0 and gain 1: the label itself.
struct Quantizer {
  double offset = 0;
  double gain = 1;
  double highest = 0;  // of the type; unused by float

  // Beyond this |d| every sample saturates, so the field need not be known there. Infinite for
  // float and for labels.
  double limit() const;

  // Clamping first turns floor into a plain conversion, which the compiler vectorises.
  template <class T>
  T sample(double d) const {
    return static_cast<T>(static_cast<std::int32_t>(std::clamp(offset + gain * d, 0.0, highest)));
  }
};
template <>
inline float Quantizer::sample<float>(double d) const {
  return static_cast<float>(gain * d);
}

// Types: uint8, uint16 and float32; of labels all integers. InputError for others.
Quantizer phantom_quantizer(PhantomKind kind, SampleType type);

// The isovalue that makes the surface d = 0, with inside = "below". Empty where there are labels:
// every value above 0 is a region of its own.
std::optional<double> phantom_isovalue(PhantomKind kind, SampleType type);

}  // namespace voxweld
