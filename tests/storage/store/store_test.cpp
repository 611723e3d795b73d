#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>
#include <cstring>

#include <cmath>
#include <fstream>
#include <thread>

#include "storage/store/open_zarr.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/types/volume.h"
#include "tests/storage/store/memory_source.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::layout_for;
using testing::MemorySource;
using testing::random_source;
using testing::read_box;
using testing::some_key;
using testing::TempDirectory;
using testing::write_store;

constexpr std::array all_types = {
    SampleType::u8,  SampleType::i8,  SampleType::u16, SampleType::i16, SampleType::u32,
    SampleType::i32, SampleType::u64, SampleType::i64, SampleType::f32, SampleType::f64};

Box3 random_box(Index3 size, std::mt19937& random) {
  Box3 box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::int64_t>(random()) % size[axis];
    const auto b = static_cast<std::int64_t>(random()) % size[axis];
    box.lo[axis] = std::min(a, b);
    box.hi[axis] = std::max(a, b) + 1;
  }
  return box;
}

std::vector<std::filesystem::path> files_under(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Store, EverySampleTypeAndOddSizesReadBack) {
  for (const SampleType type : all_types)
    for (const Index3 size : {Index3{1, 1, 1}, Index3{37, 20, 9}, Index3{8, 17, 33}}) {
      const TempDirectory directory;
      const auto source = random_source(type, size, 7);
      const auto layout = layout_for(source, directory / "a.zarr", {8, 16});
      write_store(layout, source);
      const StoreSource store(layout);
      EXPECT_EQ(read_box(store, source.all()), read_box(source, source.all()))
          << sample_type_name(type);
      EXPECT_EQ(store.info().access, Access::box);
      std::mt19937 random(3);
      for (int i = 0; i < 50; ++i) {
        const Box3 box = random_box(size, random);
        ASSERT_EQ(read_box(store, box), read_box(source, box));
      }
    }
}

TEST(Store, EveryCompressionReadsBackAndAsForeignZarrToo) {
  for (const auto compression :
       {StoreCompression::lz4, StoreCompression::zstd, StoreCompression::none}) {
    const TempDirectory directory;
    const auto source = random_source(SampleType::u16, {40, 30, 20}, 5);
    const auto layout = layout_for(source, directory / "a.zarr", {8, 32, compression, 3});
    write_store(layout, source);
    const StoreSource store(directory / "a.zarr", layout.records);
    EXPECT_EQ(store.layout().parameters.compression, compression);
    EXPECT_EQ(read_box(store, source.all()), source.samples());
    EXPECT_EQ(read_box(*open_zarr(directory / "a.zarr"), source.all()), source.samples());
  }
}

TEST(Store, GeometrySurvivesExactly) {
  const TempDirectory directory;
  auto source = random_source(SampleType::u8, {5, 6, 7}, 1);
  source.geometry().spacing = {0.337891, 1.0 / 3, 0.5};
  source.geometry().origin = {-1e-9, 1e17, 0.1};
  source.geometry().direction[0] = {0.6, 0.8, 0};
  source.geometry().unit = "mm";
  source.geometry().space = "LPS";
  const auto layout = layout_for(source, directory / "a.zarr", {8, 16});
  write_store(layout, source);
  for (const VolumeGeometry& got : {StoreSource(layout.array, layout.records).info().geometry,
                                    open_zarr(layout.array)->info().geometry}) {
    EXPECT_EQ(got.size, (Index3{5, 6, 7}));
    EXPECT_EQ(got.spacing, source.geometry().spacing);
    EXPECT_EQ(got.origin, source.geometry().origin);
    EXPECT_EQ(got.direction, source.geometry().direction);
    EXPECT_EQ(got.unit, "mm");
    EXPECT_EQ(got.space, "LPS");
  }
}

TEST(Store, KeepsSlopeAndIntercept) {
  const TempDirectory directory;
  const auto source = random_source(SampleType::i16, {5, 6, 7}, 1);
  StoreLayout layout = layout_for(source, directory / "a.zarr", {8, 16});
  write_store(layout, source);
  EXPECT_EQ(read_text_file(layout.array / "zarr.json").find("slope"), std::string::npos);
  layout.array = directory / "b.zarr";
  layout.scale = {-0.1, 1024};
  write_store(layout, source);
  EXPECT_EQ(StoreSource(layout.array, layout.records).info().scale, layout.scale);
  EXPECT_EQ(open_zarr(layout.array)->info().scale, layout.scale);
}

// Of a record without its end, which says who wrote it when (artifact/container.h).
std::vector<std::byte> contents(const std::filesystem::path& file) {
  std::vector<std::byte> bytes = read_whole_file(file);
  if (file.extension() != ".shard") return bytes;
  std::array<std::uint64_t, 2> index{};  // offset and size
  std::memcpy(index.data(), bytes.data() + 32, sizeof index);
  bytes.resize(index[0] + index[1]);
  return bytes;
}

TEST(Store, BytesDependOnNeitherBandsNorNeighbours) {
  const TempDirectory directory;
  const auto source = random_source(SampleType::i16, {70, 40, 35}, 9);
  const auto reference = layout_for(source, directory / "a.zarr", {8, 32});
  write_store(reference, source);
  const auto bands = layout_for(source, directory / "b.zarr", {8, 32});
  write_store(bands, source, 1);
  const auto rows = layout_for(source, directory / "c.zarr", {8, 32});
  write_store_metadata(rows);
  HistogramStatistics statistics(rows.type);
  ShardScratch scratch;
  const std::vector<Hash128> keys(3, some_key);
  for (std::int64_t z = 0; z < 2; ++z)
    for (std::int64_t y = 0; y < 2; ++y)
      write_shard_row(rows, {0, y, z}, keys, source, statistics, scratch);
  const auto expected = files_under(reference.array);
  EXPECT_EQ(expected.size(), 1U + 2 * 12U);
  for (const auto& other : {bands.array, rows.array}) {
    EXPECT_EQ(files_under(other).size(), expected.size());
    for (const auto& file : expected) {
      const auto twin = other / std::filesystem::relative(file, reference.array);
      EXPECT_EQ(contents(file), contents(twin)) << twin;
    }
  }
}

TEST(Store, EmptyAndOutsideChunksAreMissing) {
  const TempDirectory directory;
  MemorySource source(SampleType::u8, {20, 4, 4});
  source.set<std::uint8_t>({9, 0, 0}, 1);  // in the second of the three chunks inside the volume
  const auto layout = layout_for(source, directory / "a.zarr", {8, 32});
  write_store(layout, source);
  const auto bytes = read_whole_file(layout.shard_path({}));
  const std::size_t index = 64 * 16 + 4;
  std::vector<std::uint64_t> entries(128);
  std::memcpy(entries.data(), bytes.data() + bytes.size() - index, 1024);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(entries[2 * i] != ~std::uint64_t{0}, i == 1) << i;
  EXPECT_EQ(entries[2], 0U);
  EXPECT_EQ(entries[3], bytes.size() - index);
  const ValueRange outside = StoreSource(layout).range({{0, 0, 0}, {8, 4, 4}});
  EXPECT_FALSE(outside.empty);
  EXPECT_EQ(outside.hi, 0);
}

TEST(Store, RangesAreConservativeAndTight) {
  for (const SampleType type : {SampleType::i16, SampleType::f32, SampleType::u64}) {
    const TempDirectory directory;
    const Index3 size{45, 37, 20};
    const auto source = random_source(type, size, 21);
    const auto layout = layout_for(source, directory / "a.zarr", {8, 16});
    write_store(layout, source);
    const StoreSource store(layout);
    std::mt19937 random(4);
    for (int i = 0; i < 100; ++i) {
      const Box3 box = random_box(size, random);
      Box3 grown;  // to whole chunks: the range is that of these exactly
      for (int axis = 0; axis < 3; ++axis) {
        grown.lo[axis] = box.lo[axis] / 8 * 8;
        grown.hi[axis] = std::min(size[axis], (box.hi[axis] + 7) / 8 * 8);
      }
      const ValueRange expected = testing::value_range(type, read_box(source, grown));
      const ValueRange got = store.range(box);
      ASSERT_EQ(got.empty, expected.empty);
      ASSERT_EQ(got.any_nan, expected.any_nan);
      ASSERT_EQ(got.lo, expected.lo);
      ASSERT_EQ(got.hi, expected.hi);
    }
    EXPECT_TRUE(store.range({{100, 0, 0}, {101, 1, 1}}).empty);
  }
}

TEST(Store, RecordsHoldTheHistogram) {
  const TempDirectory directory;
  const auto source = random_source(SampleType::f32, {45, 37, 20}, 2);
  const auto layout = layout_for(source, directory / "a.zarr", {8, 16});
  write_store(layout, source);
  Histogram sum;
  sum.type = layout.type;
  ValueRange range;
  const Index3 grid = layout.shard_grid();
  for (std::int64_t z = grid.z; z-- > 0;)  // any order
    for (std::int64_t y = 0; y < grid.y; ++y)
      for (std::int64_t x = 0; x < grid.x; ++x) {
        const ShardRecord record = read_shard_record(layout, {x, y, z});
        add(sum, record.histogram);
        range = merge(range, record.range());
      }
  EXPECT_EQ(sum, testing::histogram_of(SampleType::f32, read_box(source, source.all())));
  EXPECT_EQ(range.hi, testing::value_range(SampleType::f32, read_box(source, source.all())).hi);
}

TEST(Store, ReadsFromManyThreads) {
  const TempDirectory directory;
  const auto source = random_source(SampleType::u16, {64, 64, 64}, 8);
  const auto layout = layout_for(source, directory / "a.zarr", {4, 8});  // more files than cached
  write_store(layout, source);
  const StoreSource store(layout);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (unsigned seed = 0; seed < 4; ++seed)
    threads.emplace_back([&, seed] {
      std::mt19937 random(seed);
      for (int i = 0; i < 40; ++i) {
        const Box3 box = random_box({64, 64, 64}, random);
        if (read_box(store, box) != read_box(source, box)) ++wrong;
        store.range(box);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Store, RefusesWhatMakesNoStore) {
  const TempDirectory directory;
  const MemorySource source(SampleType::u8, {8, 8, 8});
  const auto refuse = [&](StoreParameters parameters, const char* message) {
    EXPECT_THAT(testing::error_text<InputError>([&] {
                  write_store_metadata(layout_for(source, directory / "a.zarr", parameters));
                }),
                ::testing::HasSubstr(message));
  };
  refuse({0, 8}, "chunk");
  refuse({8, 12}, "12 samples given");
  refuse({8, 520}, "shard");
  refuse({8, 16, StoreCompression::lz4, 10}, "level");
  auto layout = layout_for(source, directory / "a.zarr", {8, 8});
  layout.geometry.size = {std::int64_t{1} << 32, std::int64_t{1} << 32, 8};
  EXPECT_THROW(write_store_metadata(layout), InputError);
  layout.geometry.size = {8, 8, 9};
  HistogramStatistics statistics(SampleType::u8);
  ShardScratch scratch;
  EXPECT_THROW(write_shard(layout, {}, some_key, source, statistics, scratch), InputError);
  layout.geometry.size = {8, 8, 8};
  EXPECT_THROW(write_shard(layout, {1, 0, 0}, some_key, source, statistics, scratch), InputError);
}

TEST(Store, MemoryStaysWithinTheFigure) {
  const MemorySource source(SampleType::u16, {200, 100, 90});
  const TempDirectory directory;
  const auto layout = layout_for(source, directory / "a.zarr", {8, 64});
  write_store_metadata(layout);
  HistogramStatistics statistics(SampleType::u16);
  for (const std::uint64_t band : {1U, 30000U, 1000000U}) {
    ShardScratch scratch;
    scratch.band_bytes = band;
    const std::vector<Hash128> keys(4, some_key);
    write_shard_row(layout, {}, keys, source, statistics, scratch);
    EXPECT_LE(scratch.band.capacity(), std::max<std::uint64_t>(band, 200UL * 8 * 8 * 2));
    EXPECT_LE(scratch.band.capacity() + scratch.chunk.capacity() + scratch.encoded.capacity() +
                  scratch.index.capacity(),
              shard_writer_bytes(layout, 4, band));
  }
}

RC_GTEST_PROP(StoreProperty, RoundTrip, ()) {
  const auto type = *rc::gen::elementOf(all_types);
  const auto extent = rc::gen::inRange<std::int64_t>(1, 40);
  const Index3 size{*extent, *extent, *extent};
  const auto chunk = *rc::gen::inRange<std::int64_t>(1, 17);
  const auto shard = chunk * *rc::gen::inRange<std::int64_t>(1, 5);
  const auto source = random_source(type, size, *rc::gen::arbitrary<unsigned>());
  const auto compression =
      *rc::gen::element(StoreCompression::lz4, StoreCompression::zstd, StoreCompression::none);
  const TempDirectory directory;
  const auto layout = layout_for(source, directory / "a.zarr", {chunk, shard, compression, 1});
  RC_PRE(layout.shard_grid().x * layout.shard_grid().y * layout.shard_grid().z < 500);
  write_store(layout, source, *rc::gen::inRange<std::uint64_t>(1, 100000));
  RC_ASSERT(read_box(StoreSource(layout), source.all()) == read_box(source, source.all()));
}

}  // namespace
}  // namespace voxweld
