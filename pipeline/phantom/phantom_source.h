// A phantom as a volume: what the pipeline, the brick store and the tests read from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pipeline/phantom/fields.h"
#include "pipeline/phantom/kinds.h"
#include "storage/types/volume.h"

namespace voxweld {

struct PhantomVolume {
  PhantomKind kind = PhantomKind::sphere;
  std::int64_t size = 256;  // samples a side
  SampleType type = SampleType::u16;
  std::uint64_t seed = 1;  // labels, porous and noise
  Vec3 spacing{1, 1, 1};   // only recorded: the shape is defined in voxels
  std::string unit{};      // of spacing; may be empty
  // Of labels: what the first is called, the others count on from there; 0 stays 0.
  std::uint64_t first_label = 1;
};

// Computes samples on demand; nothing is stored. Access::box: any box from any thread, the same
// bits whatever the boxes. A box of any size is computed block by block, in info().largest_decode
// bytes.
class PhantomSource : public SampleSource {
 public:
  // InputError for a size, type, spacing or labels that cannot be.
  explicit PhantomSource(const PhantomVolume& volume);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

  // The same into a larger array: rows and slices start that many samples apart.
  struct Strides {
    std::int64_t row, slice;
  };
  void read(const Box3& box, std::byte* out, Strides strides) const;

  // Boxes are cheapest in multiples of this.
  Index3 block() const { return field_->block(); }

 private:
  Quantizer quantizer_;
  std::uint64_t first_label_;  // 0: the values are no labels
  std::unique_ptr<const PhantomField> field_;
  VolumeInfo info_;
};

}  // namespace voxweld
