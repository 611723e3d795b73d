// Spools of what is read in chunks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <mutex>

#include "storage/spool/spool.h"
#include "storage/support/error.h"
#include "storage/volumes/filters.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Hash128 chunks_key{5, 6};

// Sample i has value i * 7 mod 2^16. Counts how often each chunk is decoded.
class ChunkedSource final : public SampleSource {
 public:
  ChunkedSource(Index3 size, Index3 chunk, std::uint64_t decode = 0) {
    info_.format = "chunked";
    info_.type = SampleType::u16;
    info_.geometry.size = size;
    info_.access = Access::chunks;
    info_.chunk = chunk;
    info_.largest_decode = decode;
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    auto* samples = reinterpret_cast<std::uint16_t*>(out);
    each_index(box, [&](Index3 at) { *samples++ = value(at); });
    const std::scoped_lock lock(mutex_);
    if (fail_at_ > 0 && --fail_at_ == 0) throw FormatError("chunk 7: damaged");
    largest_ = std::max(largest_, static_cast<std::uint64_t>(box.count()) * 2);
    const Index3 c = info_.chunk;
    const Box3 touched{divide(box.lo, c), divide(box.hi - splat(1), c) + splat(1)};
    each_index(touched, [&](Index3 at) { ++decodes_[{at.x, at.y, at.z}]; });
  }
  std::uint16_t value(Index3 at) const {
    const Index3 size = info_.geometry.size;
    return static_cast<std::uint16_t>(((at.z * size.y + at.y) * size.x + at.x) * 7);
  }
  void fail_at(int read) { fail_at_ = read; }
  int most_decodes() const {
    int most = 0;
    for (const auto& [chunk, times] : decodes_) most = std::max(most, times);
    return most;
  }
  std::uint64_t largest_read() const { return largest_; }
  std::size_t chunks_read() const { return decodes_.size(); }

 private:
  VolumeInfo info_;
  mutable std::mutex mutex_;
  mutable std::map<std::array<std::int64_t, 3>, int> decodes_;
  mutable std::uint64_t largest_ = 0;
  mutable int fail_at_ = 0;
};

std::vector<std::uint16_t> all_of(const SampleSource& source) {
  const Box3 box{{}, source.info().geometry.size};
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(box.count()));
  source.read(box, reinterpret_cast<std::byte*>(samples.data()));
  return samples;
}

Index3 any_size(std::int64_t most) {
  const auto side = rc::gen::inRange<std::int64_t>(1, most);
  return {*side, *side, *side};
}

RC_GTEST_PROP(ChunkSpool, DecodesEachChunkOnceInAnyNumberOfThreads, ()) {
  const testing::TempDirectory directory;
  const Index3 size = any_size(40), chunk = any_size(50);
  const ChunkedSource source(size, chunk);
  SpoolOptions options;
  options.threads = *rc::gen::inRange(1, 5);
  std::uint64_t done = 0;
  options.progress = [&](const SpoolProgress& at) { done = at.done; };
  spool_volume(source, directory / "s.raw", chunks_key, options);
  RC_ASSERT(source.most_decodes() == 1);
  RC_ASSERT(done == spool_bytes(source.info()));
  verify_spool(directory / "s.raw", chunks_key);
  RC_ASSERT(all_of(*open_spool(directory / "s.raw", chunks_key)) == all_of(source));
}

// Layers are spooled as crops of the volume: their chunks begin before them.
RC_GTEST_PROP(ChunkSpool, OfACropDecodesEachChunkOnce, ()) {
  const testing::TempDirectory directory;
  const Index3 size = any_size(40), chunk = any_size(12);
  Box3 crop;
  for (int a = 0; a < 3; ++a) {
    crop.lo[a] = *rc::gen::inRange<std::int64_t>(0, size[a]);
    crop.hi[a] = *rc::gen::inRange<std::int64_t>(crop.lo[a] + 1, size[a] + 1);
  }
  const auto source = std::make_shared<ChunkedSource>(size, chunk);
  const auto cropped = crop_source(source, crop);
  spool_volume(*cropped, directory / "s.raw", chunks_key, {});
  RC_ASSERT(source->most_decodes() == 1);
  RC_ASSERT(all_of(*open_spool(directory / "s.raw", chunks_key)) == all_of(*cropped));
}

TEST(ChunkSpool, KeepsToItsMemory) {
  const testing::TempDirectory directory;
  const ChunkedSource source({300, 200, 8}, {300, 200, 1}, 1000);
  const std::uint64_t slice = 300 * 200 * 2;
  SpoolOptions options;
  options.threads = 4;
  options.memory = 2 * (slice + 1000);
  spool_volume(source, directory / "s.raw", chunks_key, options);
  EXPECT_EQ(source.largest_read(), slice);
  EXPECT_EQ(source.chunks_read(), 8U);
  options.memory = slice + 999;
  EXPECT_THAT(testing::error_text<InputError>(
                  [&] { spool_volume(source, directory / "t.raw", chunks_key, options); }),
              AllOf(HasSubstr("needs 121000 bytes of memory"), HasSubstr("raise run.memory")));
  // Small chunks are read in runs of them.
  const ChunkedSource columns({300, 200, 150}, {1, 1, 150});
  spool_volume(columns, directory / "s.raw", chunks_key, {});
  EXPECT_EQ(columns.largest_read(), 300U * 150 * 2);
  EXPECT_EQ(columns.most_decodes(), 1);
}

TEST(ChunkSpool, LeavesNothingWhereAChunkIsDamaged) {
  const testing::TempDirectory directory;
  ChunkedSource source({30, 20, 10}, {30, 20, 1});
  source.fail_at(7);
  SpoolOptions options;
  options.threads = 3;
  EXPECT_EQ(testing::error_text<FormatError>(
                [&] { spool_volume(source, directory / "s.raw", chunks_key, options); }),
            "chunk 7: damaged");
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
  const std::atomic<bool> cancelled = true;
  options.cancel = &cancelled;
  EXPECT_THROW(spool_volume(source, directory / "s.raw", chunks_key, options), Interrupted);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

}  // namespace
}  // namespace voxweld
