// Where the samples of a grid lie in the world.
#include "tests/storage/vdb/vdb_files.h"

namespace voxweld::testing {
namespace {

using openvdb::math::Transform;

class VdbGeometry : public VdbFiles {
 protected:
  VdbGeometry() : grid_(strewn<openvdb::FloatGrid>("a", 0)) {}

  // Corners of the volume lie where OpenVDB says those of the box are.
  void expect_places(const Transform::Ptr& transform) {
    grid_->setTransform(transform);
    const auto source = open_path(write("placed", {grid_}));
    const VolumeGeometry& g = source->info().geometry;
    const openvdb::CoordBBox box = grid_->evalActiveVoxelBoundingBox().expandBy(1);
    for (int corner = 0; corner < 8; ++corner) {
      openvdb::Coord index = box.min();
      Vec3 place = g.origin;
      for (int a = 0; a < 3; ++a) {
        if ((corner >> a & 1) == 0) continue;
        index[a] = box.max()[a];
        place = place + g.direction[static_cast<std::size_t>(a)] *
                            (g.spacing[a] * static_cast<double>(g.size[a] - 1));
      }
      const openvdb::Vec3d world = transform->indexToWorld(index);
      for (int a = 0; a < 3; ++a) EXPECT_NEAR(place[a], world[a], 1e-9) << corner << " " << a;
    }
    EXPECT_EQ(g.first, (Vec3{0, 0, 0}));
    EXPECT_TRUE(source->info().warnings.empty());
  }
  std::string refusal(const Transform::Ptr& transform) {
    grid_->setTransform(transform);
    return complaint(write("placed", {grid_}));
  }

  openvdb::FloatGrid::Ptr grid_;
};

TEST_F(VdbGeometry, ScalesAndPlaces) {
  expect_places(Transform::createLinearTransform(0.125));
  const auto uneven = Transform::createLinearTransform();
  uneven->postScale(openvdb::Vec3d(0.5, 1.25, 3));
  uneven->postTranslate(openvdb::Vec3d(100, -20, 7.5));
  expect_places(uneven);
  const auto source = open_path(path("placed"));
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{0.5, 1.25, 3}));
  // Index -21, -40, 99: one before the active box.
  EXPECT_EQ(source->info().geometry.origin, (Vec3{89.5, -70, 304.5}));
}

TEST_F(VdbGeometry, Turned) {
  constexpr double right_angle = 1.5707963267948966;
  for (const double angle : {right_angle, 0.3, -2.0}) {
    const auto transform = Transform::createLinearTransform();
    transform->preScale(openvdb::Vec3d(0.5, 1.25, 3));
    transform->postRotate(angle, openvdb::math::Z_AXIS);
    transform->postRotate(angle / 2, openvdb::math::X_AXIS);
    transform->postTranslate(openvdb::Vec3d(1, 2, 3));
    expect_places(transform);
  }
}

TEST_F(VdbGeometry, Mirrored) {
  const auto transform = Transform::createLinearTransform();
  transform->postScale(openvdb::Vec3d(-1, 2, 1));
  expect_places(transform);
}

TEST_F(VdbGeometry, ShearedIsRefused) {
  const auto transform = Transform::createLinearTransform();
  transform->postShear(0.25, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  expect_says(refusal(transform), {path("placed"), "grid 'a'", "sheared", "0.24", "resample"});
}

TEST_F(VdbGeometry, AFrustumIsRefused) {
  const auto frustum = Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(100)), 0.5, 10.0, 0.1);
  expect_says(refusal(frustum), {"grid 'a'", "NonlinearFrustumMap", "expected a linear"});
}

}  // namespace
}  // namespace voxweld::testing
