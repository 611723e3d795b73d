// The labels of a block of samples as numbers of a short list, so that what follows compares small
// integers whatever the type of the volume.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "storage/types/halo_block.h"
#include "storage/types/material.h"

namespace voxweld {

class MaterialBlock {
 public:
  // more: materials that shall have numbers too, though no sample is of them.
  // Preconditions: the samples of `block` are integers. Values below zero are left out.
  void fill(const HaloBlock& block, const MaterialRules& rules,
            std::span<const Material> more = {});

  // The materials there are, ascending, and `exterior` as the last, whether there or not: so
  // numbers compare as materials do.
  const std::vector<Material>& materials() const { return materials_; }
  std::uint32_t outside() const { return static_cast<std::uint32_t>(materials_.size()) - 1; }
  // The same samples as u32, each its material's place in the list; lives until the next call.
  const HaloBlock& block() const { return block_; }

  // The same samples as u8, 1 where they are of any material; lives until the next fill.
  const HaloBlock& any();

 private:
  template <class T>
  void number_values(const HaloBlock& block, const MaterialRules& rules);

  std::vector<Material> materials_;
  std::vector<std::uint32_t> numbers_;
  std::vector<std::uint8_t> any_;
  bool any_is_filled_ = false;
  HaloBlock block_, any_block_;
  std::unordered_map<std::uint64_t, std::uint32_t> seen_;  // value to place in found_
  std::vector<Material> found_;                            // in the order they were met
  std::vector<std::uint32_t> places_;                      // of those in materials_
};

}  // namespace voxweld
