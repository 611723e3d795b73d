// Whatever happens to the files of a store, it is named or makes no difference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/memory_source.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::layout_for;
using testing::MemorySource;
using testing::read_box;
using testing::some_key;
using testing::TempDirectory;
using testing::write_store;

// Smooth enough to compress, and with an empty chunk.
MemorySource small_source() {
  MemorySource source(SampleType::u16, {14, 8, 8});
  each_index(splat(8), [&](Index3 at) {
    source.set(at, static_cast<std::uint16_t>(at.x * 5 + at.y * 3 + at.z));
  });
  return source;
}

class Damage : public ::testing::Test {
 protected:
  Damage() : source_(small_source()), layout_(layout_for(source_, directory_ / "a.zarr", {4, 16})) {
    write_store(layout_, source_);
  }

  // Named, with the file, or the values are right all the same.
  bool named_or_harmless(const std::filesystem::path& file) {
    try {
      const StoreSource store(layout_.array, layout_.records);
      store.range(source_.all());
      return read_box(store, source_.all()) == source_.samples();
    } catch (const DamagedArtifact& error) {
      return error.path() == file.string();
    } catch (const FormatError& error) {
      return std::string(error.what()).starts_with(file.string());
    }
  }

  void check_every_change(const std::filesystem::path& file, bool harmless_flips) {
    const auto whole = read_whole_file(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      write_whole_file(file, std::span(whole).first(size), Durability::rename_only);
      ASSERT_TRUE(named_or_harmless(file)) << "cut at " << size;
      ASSERT_FALSE(shard_is_current(layout_, {}, some_key) && file.filename() != "zarr.json");
    }
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const int bit : {0, 3, 7}) {
        auto flipped = whole;
        flipped[at] ^= static_cast<std::byte>(1 << bit);
        write_whole_file(file, flipped, Durability::rename_only);
        ASSERT_TRUE(named_or_harmless(file)) << "byte " << at;
        if (!harmless_flips) {
          ASSERT_THROW(
              {
                const StoreSource store(layout_);
                store.range(source_.all());
                read_box(store, source_.all());
              },
              DamagedArtifact)
              << "byte " << at;
          ASSERT_FALSE(shard_is_current(layout_, {}, some_key, ShardCheck::content));
        }
      }
    write_whole_file(file, whole, Durability::rename_only);
  }

  const TempDirectory directory_;
  MemorySource source_;
  StoreLayout layout_;
};

TEST_F(Damage, OfAShardIsNamed) {
  check_every_change(layout_.shard_path({}), false);
}

TEST_F(Damage, OfARecordIsNamed) {
  check_every_change(layout_.record_path({}), false);
}

TEST_F(Damage, OfTheMetadataIsNamed) {
  check_every_change(layout_.array / "zarr.json", true);
}

TEST_F(Damage, MissingFilesAreNamed) {
  const StoreSource store(layout_);
  std::filesystem::remove(layout_.record_path({}));
  EXPECT_THROW(store.range(source_.all()), DamagedArtifact);
  std::filesystem::remove(layout_.shard_path({}));
  try {
    read_box(store, source_.all());
    FAIL();
  } catch (const DamagedArtifact& error) {
    EXPECT_EQ(error.path(), layout_.shard_path({}).string());
    EXPECT_THAT(error.what(), ::testing::HasSubstr("missing"));
  }
}

TEST_F(Damage, OnlyTheRightKeyIsCurrent) {
  EXPECT_TRUE(shard_is_current(layout_, {}, some_key));
  EXPECT_TRUE(shard_is_current(layout_, {}, some_key, ShardCheck::content));
  EXPECT_FALSE(shard_is_current(layout_, {}, {11, 23}));
  auto other = layout_;
  other.parameters.chunk = 8;
  EXPECT_FALSE(shard_is_current(other, {}, some_key));
}

// A source that fails after some reads.
class FailingSource final : public SampleSource {
 public:
  explicit FailingSource(const SampleSource& inner) : inner_(inner) {}
  const VolumeInfo& info() const override { return inner_.info(); }
  void read(const Box3& box, std::byte* out) const override {
    if (box.lo.z > 0) throw StorageError("no more");
    inner_.read(box, out);
  }

 private:
  const SampleSource& inner_;
};

TEST_F(Damage, AFailedWriteLeavesTheOldShardWhole) {
  HistogramStatistics statistics(SampleType::u16);
  ShardScratch scratch;
  scratch.band_bytes = 1;
  EXPECT_THROW(write_shard(layout_, {}, {5, 5}, FailingSource(source_), statistics, scratch),
               StorageError);
  EXPECT_TRUE(shard_is_current(layout_, {}, some_key, ShardCheck::content));
  EXPECT_EQ(read_box(StoreSource(layout_), source_.all()), source_.samples());
  // What the failed one counted does not reach the next shard's histogram.
  write_shard(layout_, {}, {5, 5}, source_, statistics, scratch);
  EXPECT_EQ(read_shard_record(layout_, {}).histogram,
            testing::histogram_of(SampleType::u16, source_.samples()));
}

TEST_F(Damage, ARewrittenShardIsNeverVouchedForByTheOldRecord) {
  // As a crash between the two renames leaves it: the new shard, no record.
  const auto before = read_whole_file(layout_.shard_path({}));
  std::filesystem::remove(layout_.record_path({}));
  EXPECT_FALSE(shard_is_current(layout_, {}, some_key));
  // An old record that cannot be removed keeps the new shard away.
  std::filesystem::create_directories(layout_.record_path({}) / "in the way");
  source_.set({1, 1, 1}, std::uint16_t{500});
  HistogramStatistics statistics(SampleType::u16);
  ShardScratch scratch;
  EXPECT_THROW(write_shard(layout_, {}, {5, 5}, source_, statistics, scratch), StorageError);
  EXPECT_EQ(read_whole_file(layout_.shard_path({})), before);
}

}  // namespace
}  // namespace voxweld
