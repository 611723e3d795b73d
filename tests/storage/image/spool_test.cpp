#include "storage/spool/spool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <thread>

#include "storage/image/stack_source.h"
#include "storage/spool/spool_record.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/image/tiff_writer.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Hash128 key{11, 12};

// Sample i has value i * 7 mod 2^16; counts how often each slice's rows are asked for.
class CountingSource final : public SampleSource {
 public:
  CountingSource(Index3 size, Access access, std::uint64_t decode = 0) {
    info_.format = "counting";
    info_.type = SampleType::u16;
    info_.geometry.size = size;
    info_.geometry.spacing = {0.5, 0.25, 2};
    info_.geometry.origin = {1, 2, 3};
    info_.geometry.direction[1] = {0, 0, 1};
    info_.geometry.unit = "mm";
    info_.geometry.space = "LPS";
    info_.scale = {-0.5, 1024};
    info_.access = access;
    info_.largest_decode = decode;
    info_.files = {{"a.tif", 10, 20}, {"b.tif", 30, 40}};
    info_.warnings = {"careful"};
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    EXPECT_EQ(box.size().x, info_.geometry.size.x);
    rows_read += box.size().y * box.size().z;
    largest_read = std::max(largest_read, box.count() * 2);
    auto* samples = reinterpret_cast<std::uint16_t*>(out);
    each_index(box, [&](Index3 at) { *samples++ = value(at); });
  }
  std::uint16_t value(Index3 at) const {
    const Index3 size = info_.geometry.size;
    return static_cast<std::uint16_t>(((at.z * size.y + at.y) * size.x + at.x) * 7);
  }
  mutable std::int64_t rows_read = 0, largest_read = 0;

 private:
  VolumeInfo info_;
};

void expect_box(const SampleSource& spool, const CountingSource& source, const Box3& box) {
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(box.count()));
  spool.read(box, reinterpret_cast<std::byte*>(samples.data()));
  std::vector<std::uint16_t> expected;
  each_index(box, [&](Index3 at) { expected.push_back(source.value(at)); });
  ASSERT_EQ(samples, expected);
}

TEST(Spool, KeepsTheFactsAndDecodesEachRowOnce) {
  const testing::TempDirectory directory;
  const CountingSource source({30, 20, 10}, Access::slice, 100);
  std::vector<std::uint64_t> progress;
  SpoolOptions options;
  options.memory = 100 + 7 * 60;
  options.progress = [&](const SpoolProgress& at) {
    EXPECT_EQ(at.total, 12000U);
    progress.push_back(at.done);
  };
  spool_volume(source, directory / "s.raw", key, options);
  EXPECT_EQ(source.rows_read, 200);
  EXPECT_LE(source.largest_read, 7 * 60);
  EXPECT_EQ(progress.size(), 30U);
  EXPECT_EQ(progress.back(), 12000U);
  EXPECT_EQ(std::filesystem::file_size(directory / "s.raw"), spool_bytes(source.info()));

  const auto spool = open_spool(directory / "s.raw", key);
  const VolumeInfo& info = spool->info();
  EXPECT_EQ(info.access, Access::box);
  EXPECT_LE(info.largest_decode, 1U << 20);
  EXPECT_EQ(info.format, "counting");
  EXPECT_EQ(info.geometry.size, source.info().geometry.size);
  EXPECT_EQ(info.geometry.spacing, source.info().geometry.spacing);
  EXPECT_EQ(info.geometry.origin, source.info().geometry.origin);
  EXPECT_EQ(info.geometry.direction, source.info().geometry.direction);
  EXPECT_EQ(info.geometry.unit, "mm");
  EXPECT_EQ(info.geometry.space, "LPS");
  EXPECT_EQ(info.scale, (ValueScale{-0.5, 1024}));
  ASSERT_EQ(info.files.size(), 2U);
  EXPECT_EQ(info.files[1].path, "b.tif");
  EXPECT_EQ(info.files[1].state.mtime_ns, 40);
  EXPECT_EQ(info.warnings, source.info().warnings);
  verify_spool(directory / "s.raw", key);
}

TEST(Spool, GivesEveryBox) {
  const testing::TempDirectory directory;
  const CountingSource source({37, 23, 11}, Access::stream);
  spool_volume(source, directory / "s.raw", key, {});
  const auto spool = open_spool(directory / "s.raw", key);
  EXPECT_TRUE(rc::check("spool equals source", [&] {
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto size = source.info().geometry.size[axis];
      box.lo[axis] = *rc::gen::inRange<std::int64_t>(0, size);
      box.hi[axis] = *rc::gen::inRange<std::int64_t>(box.lo[axis] + 1, size + 1);
    }
    expect_box(*spool, source, box);
  }));
}

TEST(Spool, ReadsWideRowsAndLongRuns) {
  const testing::TempDirectory directory;
  // Strides over the gap worth bridging, and runs longer than the scratch.
  for (const Index3 size : {Index3{20000, 40, 2}, Index3{600, 2000, 2}, Index3{600000, 3, 2}}) {
    const CountingSource source(size, Access::slice);
    spool_volume(source, directory / "s.raw", key, {});
    const auto spool = open_spool(directory / "s.raw", key);
    expect_box(*spool, source, {{5, 1, 0}, {size.x / 3, size.y, 2}});
    expect_box(*spool, source, {{size.x - 5, 0, 1}, {size.x, size.y, 2}});
    expect_box(*spool, source, {{1, 0, 0}, {size.x, size.y, 1}});
    expect_box(*spool, source, {{0, 1, 0}, {size.x, size.y, 2}});
  }
}

TEST(Spool, ServesManyThreads) {
  const testing::TempDirectory directory;
  const CountingSource source({50, 40, 20}, Access::slice);
  spool_volume(source, directory / "s.raw", key, {});
  const auto spool = open_spool(directory / "s.raw", key);
  std::vector<std::thread> threads;
  for (std::int64_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::int64_t i = 0; i < 50; ++i)
        expect_box(*spool, source, {{t, i % 30, t}, {t + 40, i % 30 + 10, t + 10}});
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(Spool, SaysHowMuchMemoryItNeeds) {
  const testing::TempDirectory directory;
  const CountingSource slices({30, 20, 10}, Access::slice, 100);
  const CountingSource stream({30, 20, 10}, Access::stream, 100);
  EXPECT_EQ(spool_memory_needed(slices.info()), 160U);
  EXPECT_EQ(spool_memory_needed(stream.info()), 1300U);
  SpoolOptions options;
  options.memory = 160;
  spool_volume(slices, directory / "s.raw", key, options);
  verify_spool(directory / "s.raw", key);
  EXPECT_THAT(testing::error_text<InputError>(
                  [&] { spool_volume(stream, directory / "t.raw", key, options); }),
              AllOf(HasSubstr("needs 1300 bytes"), HasSubstr("160 are given")));
}

TEST(Spool, IsKnownByItsKey) {
  const testing::TempDirectory directory;
  const auto path = directory / "s.raw";
  const CountingSource source({8, 8, 8}, Access::slice);
  EXPECT_THROW(open_spool(path, key), StorageError);
  spool_volume(source, path, key, {});
  EXPECT_NO_THROW(open_spool(path, key));
  EXPECT_THROW(open_spool(path, {1, 2}), DamagedArtifact);
  std::filesystem::resize_file(path, 1023);
  EXPECT_THROW(open_spool(path, key), DamagedArtifact);
  spool_volume(source, path, {1, 2}, {});
  EXPECT_NO_THROW(open_spool(path, {1, 2}));
  std::filesystem::resize_file(spool_record_path(path), 100);
  EXPECT_THROW(open_spool(path, {1, 2}), DamagedArtifact);
}

TEST(Spool, FindsFlippedBits) {
  const testing::TempDirectory directory;
  const auto path = directory / "s.raw";
  spool_volume(CountingSource({8, 8, 8}, Access::slice), path, key, {});
  auto data = read_whole_file(path);
  data[77] ^= std::byte{4};
  write_whole_file(path, data, Durability::rename_only);
  EXPECT_THROW(verify_spool(path, key), DamagedArtifact);
}

TEST(Spool, LeavesNothingWhenStopped) {
  const testing::TempDirectory directory;
  const CountingSource source({8, 8, 8}, Access::slice);
  const auto path = directory / "s.raw";
  spool_volume(source, path, key, {});
  std::atomic<bool> cancel{false};
  SpoolOptions options;
  options.cancel = &cancel;
  options.progress = [&](const SpoolProgress& at) { cancel = at.done >= 512; };
  EXPECT_THROW(spool_volume(source, path, {1, 2}, options), Interrupted);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Spool, RefusesWhatTheDiskCannotHold) {
  const testing::TempDirectory directory;
  const CountingSource source({1 << 16, 1 << 16, 1 << 16}, Access::slice);
  EXPECT_THAT(testing::error_text<StorageError>(
                  [&] { spool_volume(source, directory / "s.raw", key, {}); }),
              AllOf(HasSubstr("s.raw"), HasSubstr("562949953421312 bytes")));
  EXPECT_EQ(source.rows_read, 0);
  EXPECT_THROW(spool_bytes(CountingSource({1LL << 30, 1LL << 30, 8}, Access::slice).info()),
               InputError);
}

TEST(Spool, OfAStackEqualsTheStack) {
  const testing::TempDirectory directory;
  std::vector<testing::TiffPage> pages;
  for (int z = 0; z < 6; ++z) {
    std::vector<float> samples(40 * 30);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = static_cast<float>(i) * 0.37F + static_cast<float>(z);
    pages.push_back(testing::tiff_page(40, 30, SampleType::f32, samples));
    pages.back().deflate = true;
    pages.back().strip_rows = 7;
  }
  testing::write_tiff(directory / "a.tif", pages);
  const auto source = open_stack({(directory / "a.tif").string()});
  SpoolOptions options;
  options.memory = spool_memory_needed(source->info()) + 4 * 160;
  spool_volume(*source, directory / "s.raw", key, options);
  std::vector<std::byte> expected;
  for (const auto& page : pages)
    expected.insert(expected.end(), page.data.begin(), page.data.end());
  EXPECT_EQ(read_whole_file(directory / "s.raw"), expected);
}

}  // namespace
}  // namespace voxweld
