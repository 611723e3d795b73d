#include "storage/types/counted_from_zero.h"
#include "storage/volumes/filters.h"
#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

// A source of any access over known samples, which checks that it is read as that access demands.
class StrictSource final : public SampleSource {
 public:
  StrictSource(const KnownVolume& volume, Access access)
      : StrictSource(volume, access, geometry_of(volume.size)) {}
  StrictSource(const KnownVolume& volume, Access access, const VolumeGeometry& geometry)
      : volume_(volume) {
    info_.type = volume.type;
    info_.geometry = geometry;
    info_.access = access;
    info_.largest_decode = 1000;
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    if (info_.access != Access::box && box.size().x != volume_.size.x)
      throw std::logic_error("not whole rows");
    if (info_.access >= Access::slice && box.size().y != volume_.size.y)
      throw std::logic_error("not whole slices");
    if (info_.access == Access::stream && box.lo.z < next_z_) throw std::logic_error("falling z");
    next_z_ = box.hi.z;
    const Bytes bytes = volume_.box(box);
    std::ranges::copy(bytes, out);
  }

 private:
  KnownVolume volume_;
  VolumeInfo info_;
  mutable std::int64_t next_z_ = 0;
};

TEST(Crop, EveryAccess) {
  // Rows of 480 kB: bands of two rows.
  for (const Index3 size : {Index3{9, 8, 7}, {60000, 7, 4}}) {
    const KnownVolume volume = make_volume(SampleType::f64, size);
    for (const Access access : {Access::box, Access::rows, Access::slice, Access::stream})
      for (const Box3& crop :
           {Box3{{2, 1, 1}, {7, 6, 4}}, Box3{{0, 1, 1}, {size.x, 6, 4}}, Box3{{0, 0, 2}, size}}) {
        const auto source = crop_source(std::make_shared<StrictSource>(volume, access), crop);
        EXPECT_EQ(source->info().access, access);
        EXPECT_GE(source->info().largest_decode, 1000U);
        for (std::int64_t z = 0; z < crop.size().z; ++z) {
          const Box3 box{{0, 0, z}, {crop.size().x, crop.size().y, z + 1}};
          ASSERT_EQ(read_box(*source, box), volume.box({box.lo + crop.lo, box.hi + crop.lo}));
        }
      }
  }
}

TEST(Crop, KeepsItsCoordinatesAndSoItsPlaceInTheWorld) {
  const KnownVolume volume = make_volume(SampleType::u8, {9, 8, 7});
  VolumeGeometry geometry = geometry_of(volume.size);
  geometry.spacing = {2, 3, 4};
  geometry.origin = {100, 200, 300};
  geometry.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
  const auto source = std::make_shared<StrictSource>(volume, Access::box, geometry);
  const auto crop = crop_source(source, {{1, 2, 3}, {5, 6, 7}});
  EXPECT_EQ(crop->info().geometry.origin, geometry.origin);
  EXPECT_EQ(crop->info().geometry.first, (Vec3{2, 6, 12}));
  const VolumeGeometry alone = counted_from_zero(crop->info().geometry);
  EXPECT_EQ(alone.origin, (Vec3{100 - 6, 200 + 2, 300 + 12}));
  EXPECT_EQ(alone.first, Vec3{});
  EXPECT_EQ(crop->info().geometry.size, (Index3{4, 4, 4}));
  EXPECT_EQ(crop->info().geometry.spacing, geometry.spacing);
}

}  // namespace
}  // namespace voxweld::testing
