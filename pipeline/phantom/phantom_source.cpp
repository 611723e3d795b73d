#include "pipeline/phantom/phantom_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "storage/support/error.h"
#include "storage/types/label_range.h"

namespace voxweld {
namespace {

VolumeInfo describe(const PhantomVolume& volume, const PhantomField& field) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(volume.spacing[axis] > 0) || !std::isfinite(volume.spacing[axis]))
      throw InputError(fmt::format("phantom {}: spacing {} on axis {} must be a positive number",
                                   phantom_kind_name(volume.kind), volume.spacing[axis],
                                   "xyz"[axis]));
  if (volume.unit.find_first_of("\"\n\r") != std::string::npos)
    throw InputError(fmt::format("phantom {}: unit {} must not hold quotes or line breaks",
                                 phantom_kind_name(volume.kind), volume.unit));
  VolumeInfo info;
  info.format = "phantom";
  info.type = volume.type;
  info.geometry.size = splat(volume.size);
  info.geometry.spacing = volume.spacing;
  info.geometry.unit = volume.unit;
  info.access = Access::box;
  const Index3 block = min(field.block(), splat(volume.size));
  info.largest_decode = static_cast<std::uint64_t>(block.x * block.y * block.z) * sizeof(double) +
                        field.scratch_bytes();
  return info;
}

// The labels fit the type, and none is what stands for the outside (storage/types/material.h).
std::uint64_t checked_first_label(const PhantomVolume& volume) {
  const std::uint64_t count = phantom_labels(volume.kind);
  if (count == 0) return 0;
  const std::uint64_t highest = dispatch_sample_type(volume.type, [](auto tag) -> std::uint64_t {
    using T = typename decltype(tag)::type;
    if constexpr (std::is_integral_v<T>)
      return std::min(highest_label, static_cast<std::uint64_t>(std::numeric_limits<T>::max()));
    return highest_label;
  });
  if (volume.first_label == 0 || highest < count || volume.first_label > highest - count + 1)
    throw InputError(fmt::format(
        "phantom {}: {} labels from {} on do not fit {}, whose labels end at {}{}",
        phantom_kind_name(volume.kind), count, volume.first_label, sample_type_name(volume.type),
        highest, volume.first_label == 0 ? "; 0 is what lies around them" : ""));
  return volume.first_label;
}

void quantize_labels(SampleType type, std::uint64_t first, const double* from, std::int64_t count,
                     std::byte* out) {
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    T* const to = reinterpret_cast<T*>(out);
    for (std::int64_t i = 0; i < count; ++i) to[i] = label_sample<T>(from[i], first);
  });
}

template <class T>
void quantize(const Quantizer& quantizer, const double* from, std::int64_t count, std::byte* out) {
  T* const to = reinterpret_cast<T*>(out);
  for (std::int64_t i = 0; i < count; ++i) to[i] = quantizer.sample<T>(from[i]);
}

void quantize(SampleType type, const Quantizer& quantizer, const double* from, std::int64_t count,
              std::byte* out) {
  if (type == SampleType::u8)
    quantize<std::uint8_t>(quantizer, from, count, out);
  else if (type == SampleType::u16)
    quantize<std::uint16_t>(quantizer, from, count, out);
  else
    quantize<float>(quantizer, from, count, out);
}

// Calls f(block) for the blocks that box is cut into.
template <class F>
void for_each_block(const Box3& box, Index3 block, F&& f) {
  for (std::int64_t z = box.lo.z; z < box.hi.z; z += block.z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; y += block.y)
      for (std::int64_t x = box.lo.x; x < box.hi.x; x += block.x)
        f(Box3{{x, y, z}, min(Index3{x, y, z} + block, box.hi)});
}

}  // namespace

PhantomSource::PhantomSource(const PhantomVolume& volume)
    : quantizer_(phantom_quantizer(volume.kind, volume.type)),
      first_label_(checked_first_label(volume)),
      field_(make_phantom_field(volume.kind, volume.size, volume.seed)),
      info_(describe(volume, *field_)) {}

void PhantomSource::read(const Box3& box, std::byte* out) const {
  const Index3 size = box.size();
  read(box, out, {size.x, size.x * size.y});
}

void PhantomSource::read(const Box3& box, std::byte* out, Strides strides) const {
  const auto bytes = static_cast<std::int64_t>(sample_bytes(info_.type));
  const Index3 block = min(field_->block(), box.size());
  std::vector<double> values(static_cast<std::size_t>(block.x * block.y * block.z));
  for_each_block(box, block, [&](const Box3& b) {
    field_->fill(b, quantizer_.limit(), values.data());
    const double* from = values.data();
    const Index3 n = b.size(), at = b.lo - box.lo;
    for (std::int64_t z = 0; z < n.z; ++z)
      for (std::int64_t y = 0; y < n.y; ++y, from += n.x) {
        const std::int64_t first = (at.z + z) * strides.slice + (at.y + y) * strides.row + at.x;
        if (first_label_ > 0)
          quantize_labels(info_.type, first_label_, from, n.x, out + first * bytes);
        else
          quantize(info_.type, quantizer_, from, n.x, out + first * bytes);
      }
  });
}

}  // namespace voxweld
