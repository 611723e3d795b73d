// What OpenVDB says is at a voxel, our reader says too.

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include "tests/storage/vdb/vdb_files.h"

namespace voxweld::testing {
namespace {

namespace io = openvdb::io;

class VdbSamples : public VdbFiles {
 protected:
  template <class Sample, class Grid>
  void expect_grid(const std::string& name, const typename Grid::Ptr& grid,
                   std::uint32_t compression = io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK) {
    SCOPED_TRACE(name);
    const std::string file = write(name, {grid}, compression);
    // As the file has it: halves have lost digits.
    io::File back(file);
    back.open();
    const auto stored = openvdb::gridPtrCast<Grid>(back.readGrid(grid->getName()));
    const auto source = open_volume({.path = file});
    EXPECT_EQ(source->info().format, "vdb");
    expect_volume(*source, known_grid<Sample>(*stored));
  }
};

TEST_F(VdbSamples, EveryType) {
  expect_grid<float, openvdb::FloatGrid>("float", strewn<openvdb::FloatGrid>("a", -1.5F));
  expect_grid<double, openvdb::DoubleGrid>("double", strewn<openvdb::DoubleGrid>("a", 1e300));
  expect_grid<std::int32_t, openvdb::Int32Grid>("int32", strewn<openvdb::Int32Grid>("a", -7));
  expect_grid<std::int64_t, openvdb::Int64Grid>(
      "int64", strewn<openvdb::Int64Grid>("a", std::int64_t{1} << 60));
  expect_grid<std::uint8_t, openvdb::BoolGrid>("bool", strewn<openvdb::BoolGrid>("a", false));
  expect_grid<std::uint8_t, openvdb::BoolGrid>("true", strewn<openvdb::BoolGrid>("a", true));
}

TEST_F(VdbSamples, MasksAreWhatIsActive) {
  auto mask = openvdb::MaskGrid::create();
  mask->topologyUnion(*strewn<openvdb::FloatGrid>("a", 0));
  expect_grid<std::uint8_t, openvdb::MaskGrid>("mask", mask);
}

TEST_F(VdbSamples, FloatsStoredAsHalves) {
  for (const bool doubled : {false, true}) {
    auto grid = strewn<openvdb::FloatGrid>("a", 0.1F);
    auto wide = strewn<openvdb::DoubleGrid>("a", 0.1);
    grid->setSaveFloatAsHalf(true);
    wide->setSaveFloatAsHalf(true);
    if (doubled)
      expect_grid<double, openvdb::DoubleGrid>("wide", wide);
    else
      expect_grid<float, openvdb::FloatGrid>("half", grid);
  }
}

TEST_F(VdbSamples, EveryCompression) {
  for (const std::uint32_t flags :
       {std::uint32_t{io::COMPRESS_NONE}, std::uint32_t{io::COMPRESS_ZIP},
        std::uint32_t{io::COMPRESS_ACTIVE_MASK},
        std::uint32_t{io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK},
        std::uint32_t{io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK}})
    expect_grid<float, openvdb::FloatGrid>("flags" + std::to_string(flags),
                                           strewn<openvdb::FloatGrid>("a", -1.5F), flags);
}

TEST_F(VdbSamples, ALevelSetIsNegativeWithinAndSaysItsSurface) {
  expect_grid<float, openvdb::FloatGrid>("ball", level_set_ball());
  const auto source = open_path(path("ball"));
  const Index3 size = source->info().geometry.size;
  const Index3 middle{size.x / 2, size.y / 2, size.z / 2};
  float value = 0;
  source->read({middle, middle + splat(1)}, reinterpret_cast<std::byte*>(&value));
  EXPECT_EQ(value, -1.5F);  // three voxels
  ASSERT_TRUE(source->info().surface);
  EXPECT_EQ(source->info().surface->isovalue, 0);
  EXPECT_TRUE(source->info().surface->inside_below);
}

TEST_F(VdbSamples, AFogVolumeHasNoKnownSurface) {
  // As openvdb::tools::sdfToFogVolume makes one, which takes the compiler half a minute.
  const auto ball = level_set_ball();
  auto fog = openvdb::FloatGrid::create(0.0F);
  fog->setName("fog");
  fog->setTransform(ball->transformPtr());
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  for (auto inside = ball->cbeginValueOn(); inside; ++inside)
    if (*inside < 0) fog->tree().setValue(inside.getCoord(), std::min(-*inside / 1.5F, 1.0F));
  expect_grid<float, openvdb::FloatGrid>("fog", fog);
  EXPECT_FALSE(open_path(path("fog"))->info().surface);
}

// Tiles of 8, 128 and 4096 voxels a side, which no leaf holds.
TEST_F(VdbSamples, LargeConstantRegions) {
  auto grid = openvdb::FloatGrid::create(0.25F);
  grid->setName("a");
  grid->fill({{-130, -7, 3}, {140, 130, 139}}, 3.0F);
  grid->fill({{0, 0, 0}, {10, 20, 30}}, -3.0F, false);
  EXPECT_GT(grid->tree().activeTileCount(), 0U);
  expect_grid<float, openvdb::FloatGrid>("tiles", grid);
}

// A tile of the root, where boxes have no leaf at all.
TEST_F(VdbSamples, ATileOfTheRoot) {
  auto grid = openvdb::FloatGrid::create(0.25F);
  grid->setName("a");
  grid->tree().addTile(3, {0, 0, 0}, 7.0F, true);
  write("root", {grid});
  const auto source = open_path(path("root"));
  EXPECT_EQ(source->info().geometry.size, splat(4098));
  float values[3]{};
  const Index3 corner = splat(4095);
  source->read({corner, corner + Index3{3, 1, 1}}, reinterpret_cast<std::byte*>(values));
  EXPECT_THAT(values, ::testing::ElementsAre(7, 7, 0.25F));
}

// The sample behind the last voxel that a grid can have.
TEST_F(VdbSamples, VoxelsAtTheEndsOfTheIndices) {
  constexpr int least = std::numeric_limits<int>::min(), most = std::numeric_limits<int>::max();
  for (const int end : {least, most}) {
    auto grid = openvdb::FloatGrid::create(-4.0F);
    grid->setName("a");
    grid->tree().setValue({end, end, end}, 2.0F);
    write("end", {grid});
    const auto source = open_path(path("end"));
    ASSERT_EQ(source->info().geometry.size, splat(3));
    float values[27]{};
    source->read({{}, splat(3)}, reinterpret_cast<std::byte*>(values));
    for (int i = 0; i < 27; ++i) EXPECT_EQ(values[i], i == 13 ? 2.0F : -4.0F) << i;
  }
}

// Other threads hold locks of theirs while a child is made and asked.
TEST_F(VdbSamples, ManyThreadsReadAtOnce) {
  const auto ball = level_set_ball(40);
  write("ball", {ball});
  const KnownVolume known = known_grid<float>(*ball);
  const auto source = open_path(path("ball"));
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (unsigned seed = 0; seed < 6; ++seed)
    threads.emplace_back([&, seed] {
      std::mt19937_64 random(seed);
      for (int i = 0; i < 10; ++i) {
        const Box3 box = random_box(known.size, random);
        if (read_box(*source, box) != known.box(box)) ++wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace voxweld::testing
