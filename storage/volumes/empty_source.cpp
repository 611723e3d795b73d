#include "storage/volumes/empty_source.h"

#include <cstring>

namespace voxweld {
namespace {

class EmptySource final : public RangedSource {
 public:
  explicit EmptySource(const VolumeGeometry& geometry) {
    info_.format = "empty";
    info_.type = SampleType::u8;
    info_.geometry = geometry;
    info_.access = Access::box;
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    std::memset(out, 0, static_cast<std::size_t>(box.count()));
  }
  ValueRange range(const Box3&) const override {
    ValueRange zero;
    zero.empty = false;
    return zero;
  }

 private:
  VolumeInfo info_;
};

}  // namespace

std::unique_ptr<RangedSource> empty_source(const VolumeGeometry& geometry) {
  return std::make_unique<EmptySource>(geometry);
}

}  // namespace voxweld
