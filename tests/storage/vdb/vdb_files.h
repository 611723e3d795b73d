// .vdb files that OpenVDB writes, and what it says is in them.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <string>
#include <vector>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {

class VdbFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  std::string path(const std::string& name) const { return (folder_ / (name + ".vdb")).string(); }
  std::string write(const std::string& name, const std::vector<openvdb::GridBase::Ptr>& grids,
                    std::uint32_t compression = openvdb::io::COMPRESS_BLOSC |
                                                openvdb::io::COMPRESS_ACTIVE_MASK) const {
    openvdb::io::File file(path(name));
    file.setCompression(compression);
    file.write(grids);
    file.close();
    return path(name);
  }

  const TempDirectory folder_;
};

template <class Sample>
SampleType vdb_sample_type() {
  if constexpr (std::is_same_v<Sample, float>) return SampleType::f32;
  if constexpr (std::is_same_v<Sample, double>) return SampleType::f64;
  if constexpr (std::is_same_v<Sample, std::int32_t>) return SampleType::i32;
  if constexpr (std::is_same_v<Sample, std::int64_t>) return SampleType::i64;
  return SampleType::u8;
}

// What getValue() says of the active box and a voxel around it.
template <class Sample, class Grid>
KnownVolume known_grid(const Grid& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox().expandBy(1);
  const openvdb::Coord size = box.dim();
  KnownVolume known{vdb_sample_type<Sample>(), {size.x(), size.y(), size.z()}, {}};
  known.samples.resize(static_cast<std::size_t>(box.volume()) * sizeof(Sample));
  auto access = grid.getConstAccessor();
  std::byte* out = known.samples.data();
  for (int z = box.min().z(); z <= box.max().z(); ++z)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int x = box.min().x(); x <= box.max().x(); ++x, out += sizeof(Sample)) {
        const auto value = static_cast<Sample>(access.getValue({x, y, z}));
        std::memcpy(out, &value, sizeof value);
      }
  return known;
}

// Voxels strewn about, a constant region that fills a leaf, and single ones far from it.
template <class Grid>
typename Grid::Ptr strewn(const std::string& name, typename Grid::ValueType background) {
  using Value = typename Grid::ValueType;
  auto grid = Grid::create(background);
  grid->setName(name);
  auto access = grid->getAccessor();
  std::mt19937_64 random(3);
  for (int i = 0; i < 3000; ++i) {
    const auto at = [&](int bound) {
      return static_cast<int>(random() % static_cast<unsigned>(bound));
    };
    const openvdb::Coord where(at(50) - 20, at(40) - 39, at(30) + 100);
    access.setValue(where, static_cast<Value>(static_cast<double>(at(4000)) / 8 - 200));
  }
  grid->fill({{-16, -32, 104}, {7, -17, 119}}, static_cast<Value>(5));
  // A value that is not active stays what it was.
  access.setValueOff({0, -8, 110}, static_cast<Value>(9));
  return grid;
}

inline openvdb::FloatGrid::Ptr level_set_ball(double radius = 12, double voxel = 0.5) {
  auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(radius), openvdb::Vec3f(1, 2, 3), static_cast<float>(voxel));
  ball->setName("surface");
  return ball;
}

inline InputSpec with_grid_name(const std::string& path, const std::string& name) {
  InputSpec spec{.path = path};
  spec.select.dataset = name;
  return spec;
}

}  // namespace voxweld::testing
