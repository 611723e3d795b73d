// A volume in memory as a source: small data, and tests.
#pragma once

#include <cstddef>
#include <vector>

#include "storage/types/volume.h"

namespace voxweld {

// Any box, from any thread. `samples` in native byte order, x fastest.
class DenseSource final : public SampleSource {
 public:
  // InputError unless `samples` has exactly the bytes that size and type need.
  DenseSource(SampleType type, const VolumeGeometry& geometry, std::vector<std::byte> samples);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

 private:
  VolumeInfo info_;
  std::vector<std::byte> samples_;
};

}  // namespace voxweld
