// Counting labels in bounded memory against counting them in a map.
#include "pipeline/ingest/label_tally.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::TempDirectory;

constexpr SampleType integer_types[] = {SampleType::u8,  SampleType::i8,  SampleType::u16,
                                        SampleType::i16, SampleType::u32, SampleType::i32,
                                        SampleType::u64, SampleType::i64};

struct Labelled {
  SampleType type;
  Box3 box;
  std::vector<std::byte> samples;
  std::vector<LabelCount> counts;
  std::uint64_t negatives = 0;
};

// Runs of equal labels, some of them at the ends of the type; at most `most` others.
Labelled labelled(SampleType type, Index3 size, std::uint64_t most, unsigned seed) {
  Labelled volume{type, {{5, 70000, 9}, Index3{5, 70000, 9} + size}, {}, {}, 0};
  std::mt19937_64 random(seed);
  std::map<std::uint64_t, LabelCount> counts;
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    if constexpr (std::is_integral_v<T>) {
      using Limits = std::numeric_limits<T>;
      T value{};
      for (std::int64_t z = volume.box.lo.z; z < volume.box.hi.z; ++z)
        for (std::int64_t y = volume.box.lo.y; y < volume.box.hi.y; ++y)
          for (std::int64_t x = volume.box.lo.x; x < volume.box.hi.x; ++x) {
            const auto dice = random() % 64;
            if (dice < 24) value = static_cast<T>(random() % most * 0x9e3779b97f4a7c15U);
            if (dice == 60) value = Limits::max();
            if (dice == 61) value = Limits::lowest();
            const auto* bytes = reinterpret_cast<const std::byte*>(&value);
            volume.samples.insert(volume.samples.end(), bytes, bytes + sizeof value);
            if (value < T{0}) {
              ++volume.negatives;
              continue;
            }
            const auto at = [](std::int64_t v) { return static_cast<std::uint32_t>(v); };
            const LabelCount one{static_cast<std::uint64_t>(value),
                                 1,
                                 {at(x), at(y), at(z)},
                                 {at(x + 1), at(y + 1), at(z + 1)}};
            const auto [entry, is_new] = counts.try_emplace(one.label, one);
            if (!is_new) add(entry->second, one);
          }
    }
  });
  for (const auto& [label, count] : counts) volume.counts.push_back(count);
  return volume;
}

std::vector<LabelCount> finish(LabelTally& tally) {
  std::vector<LabelCount> counts;
  tally.finish([&](const LabelCount& count) { counts.push_back(count); });
  return counts;
}

TEST(LabelTally, CountsWhatIsThere) {
  const TempDirectory directory;
  for (const SampleType type : integer_types)
    for (const std::size_t most : {2, 16, 1 << 16}) {
      const Labelled volume = labelled(type, {17, 9, 11}, 90, 3);
      LabelTally tally(directory.path(), most);
      tally.add(type, volume.box, volume.samples);
      EXPECT_EQ(tally.negatives(), volume.negatives);
      EXPECT_EQ(finish(tally), volume.counts) << sample_type_name(type) << " " << most;
      EXPECT_TRUE(finish(tally).empty());
    }
}

// So many full tables of other labels that runs are merged before the end.
TEST(LabelTally, AnyNumberOfLabels) {
  const TempDirectory directory;
  const Labelled volume = labelled(SampleType::u64, {60, 60, 3}, 100000, 5);
  ASSERT_GT(volume.counts.size(), 2400U);
  LabelTally tally(directory.path(), 8);
  tally.add(volume.type, volume.box, volume.samples);
  EXPECT_EQ(finish(tally), volume.counts);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path())) << "the scratch file has no name";
}

// Whatever the parts and their order.
TEST(LabelTally, PartsAddUp) {
  const TempDirectory directory;
  const Labelled a = labelled(SampleType::u32, {31, 5, 6}, 300, 1);
  const Labelled b = labelled(SampleType::u32, {9, 20, 6}, 300, 2);
  const auto sum = [&](bool b_first, std::size_t most, bool counted) {
    LabelTally tally(directory.path(), most);
    for (const Labelled* part : {b_first ? &b : &a, b_first ? &a : &b})
      if (counted)
        for (const LabelCount& count : part->counts) tally.add(count);
      else
        tally.add(part->type, part->box, part->samples);
    return finish(tally);
  };
  const auto expected = sum(false, 1 << 16, false);
  for (const bool b_first : {false, true})
    for (const bool counted : {false, true})
      for (const std::size_t most : {1, 4, 1 << 10})
        EXPECT_EQ(sum(b_first, most, counted), expected);
}

TEST(LabelTally, SaysWhatItTakes) {
  EXPECT_LE(LabelTally::memory_bytes(1 << 15), 8U << 20);
  for (const std::uint64_t bytes : {1U << 20, 5U << 20, 1U << 30}) {
    const std::size_t most = LabelTally::labels_within(bytes);
    EXPECT_GT(LabelTally::memory_bytes(2 * most), bytes);
    EXPECT_TRUE(most == 1 || LabelTally::memory_bytes(most) <= bytes);
  }
}

}  // namespace
}  // namespace voxweld
