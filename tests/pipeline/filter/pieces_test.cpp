// The filters keep and fill against flood fill in memory, with so small blocks that small volumes
// have many.
#include "tests/pipeline/filter/piece_setting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "storage/artifact/piece_changes.h"
#include "storage/support/file_io.h"
#include "tests/support/by_python.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::filtered;
using testing::flood;
using testing::FloodPieces;
using testing::held_volume;
using testing::HeldVolume;
using testing::index_in;
using testing::noise;
using testing::Pattern;
using testing::read_box;
using testing::rule_of;
using testing::Setting;
using testing::TempDirectory;
using testing::test_key;
using testing::What;

// Of interest are the samples where wanted(p).
std::vector<bool> to_change(Index3 size, const PieceRule& rule, const Pattern& wanted) {
  const FloodPieces found = flood(size, wanted);
  std::size_t largest = 0;
  for (std::size_t i = 1; i < found.pieces.size(); ++i)
    if (found.pieces[i].samples > found.pieces[largest].samples) largest = i;
  std::vector<bool> changes(found.labels.size());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (found.labels[i] == 0) continue;
    const auto& piece = found.pieces[found.labels[i] - 1];
    if (rule.what == What::fill)
      changes[i] = !piece.border && piece.samples <= rule.voxels;
    else if (rule.voxels == 0)
      changes[i] = found.labels[i] - 1 != largest;
    else
      changes[i] = piece.samples < rule.voxels;
  }
  return changes;
}

std::vector<std::byte> expected_samples(const HeldVolume& volume, const PieceRule& rule,
                                        const Pattern& pattern) {
  const bool above = rule.inside == Inside::above, keep = rule.what == What::keep;
  const Index3 size = volume.info().geometry.size;
  const auto changes =
      to_change(size, rule, [&](Index3 p) { return (pattern(p) == above) == keep; });
  std::vector<std::byte> out = volume.samples;
  dispatch_sample_type(volume.info().type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const auto sample = [&](std::size_t i) {
      T value;
      std::memcpy(&value, &volume.samples[i * sizeof value], sizeof value);
      return value;
    };
    T value = sample(0);
    for (std::size_t i = 0; i < changes.size(); ++i)
      value = above == keep ? std::min(value, sample(i)) : std::max(value, sample(i));
    if (rule.value) value = static_cast<T>(*rule.value);
    for (std::size_t i = 0; i < changes.size(); ++i)
      if (changes[i]) std::memcpy(&out[i * sizeof value], &value, sizeof value);
  });
  return out;
}

std::vector<std::byte> part_of(const std::vector<std::byte>& samples, const HeldVolume& volume,
                               const Box3& box) {
  HeldVolume held = volume;
  held.samples = samples;
  return read_box(held, box);
}

// The whole and some boxes, the pass by one thread and by four.
void check_in_blocks(const HeldVolume& volume, const PieceRule& rule, const Pattern& pattern,
                     std::int64_t side) {
  const TempDirectory directory;
  Setting one(1), four(4);
  find_pieces_in_blocks(one.context, volume, rule, directory / "one", test_key, side);
  find_pieces_in_blocks(four.context, volume, rule, directory / "four", test_key, side);
  EXPECT_EQ(PieceChanges(directory / "one").content_hash(),
            PieceChanges(directory / "four").content_hash());
  const auto expected = expected_samples(volume, rule, pattern);
  const auto source = filtered(volume, directory / "four");
  const Index3 size = volume.info().geometry.size;
  EXPECT_EQ(read_box(*source, {{}, size}), expected) << side;
  std::mt19937 random(7);
  const auto below = [&](std::int64_t end) { return static_cast<std::int64_t>(random() % end); };
  for (int i = 0; i < 20; ++i) {
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = below(size[axis]);
      box.hi[axis] = box.lo[axis] + 1 + below(size[axis] - box.lo[axis]);
    }
    EXPECT_EQ(read_box(*source, box), part_of(expected, volume, box));
  }
}

void check(Index3 size, const Pattern& pattern, SampleType type = SampleType::u8) {
  const HeldVolume volume = held_volume(type, size, pattern, 3);
  for (const Inside inside : {Inside::above, Inside::below})
    for (const PieceRule& rule :
         {rule_of(What::keep, 0, inside), rule_of(What::keep, 4, inside),
          rule_of(What::fill, 3, inside), rule_of(What::fill, 1 << 20, inside)})
      for (const std::int64_t side : {4, 7, 64}) check_in_blocks(volume, rule, pattern, side);
}

TEST(Pieces, Noise) {
  for (const double density : {0.05, 0.25, 0.3116, 0.5, 0.6884, 0.75, 0.95})
    check({19, 17, 23}, noise(density, 11));
}

TEST(Pieces, SeveralLargeBlocks) {
  check({130, 70, 66}, noise(0.31, 2));
}

TEST(Pieces, EveryType) {
  for (int type = 0; type < 10; ++type)
    check({11, 9, 10}, noise(0.4, 5), static_cast<SampleType>(type));
}

// One path through all of the volume: to and fro along x, then y, then z.
TEST(Pieces, Snake) {
  check({21, 21, 21}, [](Index3 p) {
    if (p.z % 2 == 1) return p.x == 0 && p.y == (p.z % 4 == 1 ? 20 : 0);
    if (p.y % 2 == 1) return p.x == (p.y % 4 == 1 ? 20 : 0);
    return true;
  });
}

TEST(Pieces, LayersOneSampleThick) {
  for (int axis = 0; axis < 3; ++axis)
    check({15, 16, 17}, [axis](Index3 p) { return p[axis] % 4 == 3; });
}

// Teeth along z that only the last slice holds together.
TEST(Pieces, Comb) {
  check({17, 15, 30}, [](Index3 p) { return p.z == 29 || (p.x % 2 == 0 && p.y % 2 == 0); });
}

// Shells in shells, open at their tops: U after U, each of which closes late.
TEST(Pieces, UShapes) {
  for (const bool turned : {false, true})
    check({33, 20, 31}, [turned](Index3 p) {
      const std::int64_t far = std::max(std::abs(p.x - 16), turned ? p.z : 30 - p.z);
      return far % 2 == 0 && p.y > 1 && p.y < 18;
    });
}

TEST(Pieces, TouchingByEdgesAndCorners) {
  check({14, 13, 12}, [](Index3 p) { return (p.x / 2 + p.y / 2 + p.z / 2) % 2 == 0; });
  check({14, 13, 12}, [](Index3 p) { return p.x == p.y && p.y == p.z; });
}

// Boxes with a void each; every third void opens at the border through a thin channel.
TEST(Pieces, VoidsOpenAtTheBorder) {
  check({40, 26, 20}, [](Index3 p) {
    const Index3 at{p.x % 10, p.y % 13, p.z % 10};
    const bool wall = at.x >= 1 && at.y >= 1 && at.z >= 1 && at.x < 9 && at.y < 12 && at.z < 9;
    const bool hollow = at.x >= 3 && at.y >= 3 && at.z >= 3 && at.x < 7 && at.y < 10 && at.z < 7;
    const bool channel = p.x / 10 % 3 == 0 && at.y == 5 && at.z == 5;
    return wall && !hollow && !channel;
  });
}

// The first of the largest is kept; equal ones lie within blocks, across them, and in layers apart.
TEST(Pieces, OfEqualPiecesTheFirstIsKept) {
  for (const Index3 shift : {Index3{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {3, 2, 1}})
    check({24, 16, 16}, [shift](Index3 p) {
      const Index3 at = p + shift;
      return at.x % 8 < 4 && at.y % 8 < 4 && at.z % 8 < 4;
    });
}

// Chunks of the volume's own that are larger than blocks are left as they are.
TEST(Pieces, InfoSaysWhatReadingCosts) {
  class Chunked : public HeldVolume {
   public:
    Chunked() : HeldVolume(SampleType::u8, splat(300)) {
      info_.chunk = {32, 100, 1};
      info_.chunk_first = {3, 4, 0};
      info_.access = Access::chunks;
    }
  };
  const Chunked volume;
  const auto source = filtered(volume, "no such file");
  EXPECT_EQ(source->info().chunk, (Index3{64, 100, 64}));
  EXPECT_EQ(source->info().chunk_first, (Index3{0, 4, 0}));
  EXPECT_EQ(source->info().access, Access::box);
  EXPECT_EQ(source->info().geometry.size, splat(300));
  EXPECT_EQ(source->ranges(), nullptr);
}

TEST(Pieces, NothingAndEverything) {
  check({9, 8, 7}, [](Index3) { return false; });
  for (const std::uint64_t voxels : {0, 1}) {
    const HeldVolume one = held_volume(SampleType::u8, {1, 1, 1}, noise(1, 1), 1);
    check_in_blocks(one, rule_of(What::keep, voxels), noise(1, 1), 64);
    check_in_blocks(one, rule_of(What::fill, voxels), noise(1, 1), 64);
  }
  check({70, 1, 1}, noise(0.5, 1));
}

TEST(Pieces, ValueGiven) {
  const Pattern pattern = noise(0.3, 4);
  const HeldVolume volume = held_volume(SampleType::i16, {20, 20, 20}, pattern, 1);
  PieceRule rule = rule_of(What::keep, 0);
  rule.value = -1000;
  check_in_blocks(volume, rule, pattern, 7);
  rule = rule_of(What::fill, 100);
  rule.value = 3000;
  check_in_blocks(volume, rule, pattern, 7);
}

// NaNs are outside: they part pieces, and are filled.
TEST(Pieces, Nans) {
  const Index3 size{9, 9, 9};
  HeldVolume volume = held_volume(
      SampleType::f32, size, [](Index3 p) { return p != splat(4) && p.z != 2; }, 1);
  const float nan = std::nanf("");
  std::memcpy(&volume.samples[index_in(size, splat(4)) * 4], &nan, 4);
  for (std::int64_t i = 0; i < 81; ++i)
    std::memcpy(&volume.samples[static_cast<std::size_t>(162 + i) * 4], &nan, 4);
  const auto left = [&](const PieceRule& rule) {
    const TempDirectory directory;
    Setting setting;
    find_pieces_in_blocks(setting.context, volume, rule, directory / "a", test_key, 4);
    const auto bytes = read_box(*filtered(volume, directory / "a"), {{}, size});
    std::vector<float> samples(729);
    std::memcpy(samples.data(), bytes.data(), bytes.size());
    return samples;
  };
  const auto filled = left(rule_of(What::fill, 1));
  EXPECT_EQ(filled[index_in(size, splat(4))], 120);
  EXPECT_TRUE(std::isnan(filled[170])) << "reaches the border";
  PieceRule keep = rule_of(What::keep, 0);
  keep.value = 7;
  const auto kept = left(keep);
  EXPECT_EQ(kept[0], 7);
  EXPECT_TRUE(std::isnan(kept[170]));
  EXPECT_GE(kept[700], 100);
}

// Blocks without change are not there; those that change wholly have no bits.
TEST(Pieces, ArtifactIsSmall) {
  const TempDirectory directory;
  Setting setting;
  const HeldVolume volume = held_volume(
      SampleType::u8, {256, 64, 64}, [](Index3 p) { return p.x % 128 < 100; }, 1);
  find_pieces(setting.context, volume, rule_of(What::keep, 0), directory / "a", test_key);
  const PieceChanges changes(directory / "a");
  EXPECT_FALSE(changes.find(0) || changes.find(1) || changes.find(4));
  ASSERT_TRUE(changes.find(2) && changes.find(3));
  EXPECT_TRUE(changes.find(2)->all && changes.find(3)->all);
  EXPECT_EQ(changes.summary().changed_samples, 100U * 64 * 64);
}

TEST(Pieces, AsScipyLabelsThem) {
  const auto python = testing::python_with("scipy.ndimage");
  if (!python) GTEST_SKIP() << "needs python3 with the module scipy";
  const TempDirectory directory;
  Setting setting;
  const PieceRule rule = rule_of(What::keep, 0);
  const HeldVolume volume = held_volume(SampleType::u8, {150, 140, 130}, noise(0.32, 9), 1);
  find_pieces(setting.context, volume, rule, directory / "a", test_key);
  const auto left = read_box(*filtered(volume, directory / "a"), {{}, volume.info().geometry.size});
  write_whole_file(directory / "before", volume.samples, Durability::rename_only);
  write_whole_file(directory / "after", left, Durability::rename_only);
  testing::run_python(*python, directory.path(), R"(
import numpy as np
from scipy import ndimage
before = np.fromfile('before', np.uint8).reshape(130, 140, 150)
labels, count = ndimage.label(before >= 96)
sizes = np.bincount(labels.ravel())
sizes[0] = 0
after = np.where((labels > 0) & (labels != sizes.argmax()), before.min(), before)
assert count > 1000
assert (after == np.fromfile('after', np.uint8).reshape(after.shape)).all()
)");
}

}  // namespace
}  // namespace voxweld
