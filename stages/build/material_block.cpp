#include "stages/build/material_block.h"

#include <algorithm>
#include <type_traits>

namespace voxweld {

// Neighbours are mostly of one label: the last value is remembered, and the table asked only where
// it changes.
template <class T>
void MaterialBlock::number_values(const HaloBlock& block, const MaterialRules& rules) {
  const T* data = reinterpret_cast<const T*>(block.data);
  const Index3 size = block.samples.size();
  std::uint32_t* out = numbers_.data();
  bool any = false;
  T last = 0;
  std::uint32_t number = 0;
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      const T* row = data + z * block.slice + y * block.row;
      for (std::int64_t x = 0; x < size.x; ++x) {
        if (!any || row[x] != last) {
          any = true;
          last = row[x];
          const bool negative = std::is_signed_v<T> && last < 0;
          const auto value = negative ? exterior : static_cast<std::uint64_t>(last);
          const auto [at, is_new] =
              seen_.try_emplace(value, static_cast<std::uint32_t>(found_.size()));
          if (is_new) found_.push_back(negative ? exterior : rules.of(value));
          number = at->second;
        }
        *out++ = number;
      }
    }
}

void MaterialBlock::fill(const HaloBlock& block, const MaterialRules& rules,
                         std::span<const Material> more) {
  numbers_.resize(static_cast<std::size_t>(block.samples.count()));
  seen_.clear();
  found_.clear();
  if (!block.samples.empty())
    dispatch_sample_type(block.type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      if constexpr (std::is_integral_v<T>) number_values<T>(block, rules);
    });
  materials_ = found_;
  materials_.push_back(exterior);
  materials_.insert(materials_.end(), more.begin(), more.end());
  std::sort(materials_.begin(), materials_.end());
  materials_.erase(std::unique(materials_.begin(), materials_.end()), materials_.end());
  places_.clear();
  for (const Material material : found_)
    places_.push_back(static_cast<std::uint32_t>(
        std::lower_bound(materials_.begin(), materials_.end(), material) - materials_.begin()));
  for (std::uint32_t& number : numbers_) number = places_[number];
  const Index3 size = block.samples.size();
  block_ = {SampleType::u32, block.size,
            block.samples,   reinterpret_cast<const std::byte*>(numbers_.data()),
            size.x,          size.x * size.y};
  any_is_filled_ = false;
}

const HaloBlock& MaterialBlock::any() {
  if (any_is_filled_) return any_block_;
  any_.resize(numbers_.size());
  const std::uint32_t none = outside();
  std::transform(numbers_.begin(), numbers_.end(), any_.begin(),
                 [&](std::uint32_t number) { return std::uint8_t{number != none}; });
  any_block_ = block_;
  any_block_.type = SampleType::u8;
  any_block_.data = reinterpret_cast<const std::byte*>(any_.data());
  any_is_filled_ = true;
  return any_block_;
}

}  // namespace voxweld
