// Pieces within a block, and its faces, against flood fill.
#include "stages/filter/block_pieces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stages/filter/piece_join.h"
#include "tests/support/piece_volumes.h"

namespace voxweld {
namespace {

using testing::flood;
using testing::FloodPieces;
using testing::held_volume;
using testing::index_in;
using testing::noise;
using testing::Pattern;

constexpr SampleType all_types[] = {
    SampleType::u8,  SampleType::i8,  SampleType::u16, SampleType::i16, SampleType::u32,
    SampleType::i32, SampleType::u64, SampleType::i64, SampleType::f32, SampleType::f64};

bool bit_of(const BlockMask& mask, Index3 p) {
  return (mask.rows[static_cast<std::size_t>(p.y + mask.size.y * p.z)] >> p.x & 1) != 0;
}

BlockMask mask_of(Index3 size, const Pattern& pattern) {
  BlockMask mask{size, std::vector<std::uint64_t>(static_cast<std::size_t>(size.y * size.z))};
  each_index(size, [&](Index3 p) {
    if (pattern(p))
      mask.rows[static_cast<std::size_t>(p.y + size.y * p.z)] |= std::uint64_t{1} << p.x;
  });
  return mask;
}

std::vector<std::uint32_t> labels_of(const BlockMask& mask, const BlockLabels& labels) {
  const Index3 size = mask.size;
  std::vector<std::uint32_t> out(static_cast<std::size_t>(size.x * size.y * size.z));
  labels.each_run([&](const PieceRun& run, std::uint32_t piece) {
    for (std::size_t x = run.begin; x < run.end; ++x)
      out[x + static_cast<std::size_t>(size.x) * run.row] = piece + 1;
  });
  return out;
}

TEST(BlockMask, SamplesOfEveryTypeAndPart) {
  const Index3 size{70, 9, 7};
  const Pattern inside = noise(0.4, 3);
  const Box3 part{{5, 2, 1}, {69, 9, 6}};
  for (const SampleType type : all_types)
    for (const Inside side : {Inside::above, Inside::below})
      for (const bool within : {true, false}) {
        const auto volume = held_volume(type, size, inside, 1);
        BlockMask mask;
        StoredRange range;
        mask_samples(type, volume.samples, size, part, {95.5, side, within}, mask, &range);
        each_index(part, [&](Index3 p) {
          const bool expected = (inside(p) == (side == Inside::above)) == within;
          EXPECT_EQ(bit_of(mask, p - part.lo), expected) << sample_type_name(type);
        });
        EXPECT_EQ(stored_text(type, range.least), "0");
        EXPECT_EQ(stored_text(type, range.greatest), "120");
      }
}

TEST(BlockMask, NansAreOutsideAndInNoRange) {
  const float nan = std::nanf("");
  const std::vector<float> samples{nan, 3, nan, -0.0F, 7, nan};
  for (const Inside side : {Inside::above, Inside::below}) {
    BlockMask mask;
    StoredRange range;
    const auto bytes = std::as_bytes(std::span(samples));
    mask_samples(SampleType::f32, bytes, {6, 1, 1}, {{}, {6, 1, 1}}, {2, side, true}, mask, &range);
    EXPECT_EQ(mask.rows[0], side == Inside::above ? 0b010010U : 0b001000U);
    EXPECT_EQ(range.least, stored_bits(0.0F)) << "the zero without a sign";
    EXPECT_EQ(range.greatest, stored_bits(7.0F));
    mask_samples(SampleType::f32, bytes, {6, 1, 1}, {{}, {6, 1, 1}}, {2, side, false}, mask);
    EXPECT_EQ(mask.rows[0], side == Inside::above ? 0b101101U : 0b110111U);
  }
}

TEST(StoredValue, RoundsIntoTheType) {
  const auto text = [](SampleType type, double number) {
    const auto bits = nearest_stored(type, number);
    return bits ? stored_text(type, *bits) : "none";
  };
  EXPECT_EQ(text(SampleType::u8, 2.5), "2");
  EXPECT_EQ(text(SampleType::u8, 255.4), "255");
  EXPECT_EQ(text(SampleType::u8, 255.5), "none");
  EXPECT_EQ(text(SampleType::u8, -0.5), "0");
  EXPECT_EQ(text(SampleType::i8, -129), "none");
  EXPECT_EQ(text(SampleType::i16, -1000), "-1000");
  EXPECT_EQ(text(SampleType::u64, 0x1p64), "none");
  EXPECT_EQ(text(SampleType::i64, -0x1p63), "-9223372036854775808");
  EXPECT_EQ(text(SampleType::f32, 0.1), "0.1");
  EXPECT_EQ(text(SampleType::f32, 1e39), "none");
  EXPECT_EQ(text(SampleType::f64, std::nan("")), "none");
}

TEST(BlockLabels, AsFloodFill) {
  BlockLabels labels;  // used again
  for (const Index3 size : {Index3{64, 64, 64}, {1, 1, 1}, {64, 1, 5}, {3, 17, 9}, {1, 40, 2}})
    for (const double density : {0.0, 0.1, 0.31, 0.5, 0.7, 1.0}) {
      const Pattern pattern = noise(density, 17);
      const BlockMask mask = mask_of(size, pattern);
      const FloodPieces expected = flood(size, pattern);
      labels.find(mask);
      EXPECT_EQ(labels.pieces(), expected.pieces.size());
      EXPECT_EQ(labels_of(mask, labels), expected.labels) << size.x << " " << density;
    }
}

TEST(BlockLabels, EdgesAndCornersDoNotConnect) {
  const BlockMask mask = mask_of(splat(64), [](Index3 p) { return (p.x + p.y + p.z) % 2 == 0; });
  BlockLabels labels;
  labels.find(mask);
  EXPECT_EQ(labels.pieces(), 64 * 64 * 64 / 2);
}

// The face's samples, each with its piece from 1, by the runs it is written in.
std::vector<std::uint32_t> face_labels(const FaceRuns& face, std::int64_t width) {
  std::vector<std::uint32_t> out;
  std::size_t run = 0;
  for (const std::uint64_t row : face.rows)
    for (std::int64_t i = 0; i < width; ++i) {
      const bool set = (row >> i & 1) != 0;
      if (set && (i == 0 || (row >> (i - 1) & 1) == 0)) ++run;
      out.push_back(set ? face.pieces.at(run - 1) + 1 : 0);
    }
  EXPECT_EQ(run, face.pieces.size());
  return out;
}

TEST(BlockPieces, FactsAndFaces) {
  const Index3 volume{30, 40, 50};
  const Box3 block{{10, 20, 30}, {23, 31, 47}};
  const Index3 size = block.size();
  for (const double density : {0.2, 0.5, 0.9}) {
    const Pattern pattern = noise(density, 5);
    const BlockMask mask = mask_of(size, pattern);
    const FloodPieces expected = flood(size, pattern);
    BlockLabels labels;
    labels.find(mask);
    const BlockPieces found = describe_pieces(mask, labels, block, volume);
    ASSERT_EQ(found.facts.size(), expected.pieces.size());
    for (std::size_t i = 0; i < found.facts.size(); ++i) {
      EXPECT_EQ(found.facts[i].samples, expected.pieces[i].samples);
      EXPECT_EQ(found.open[i] != 0, expected.pieces[i].border) << "all faces lie inside";
      EXPECT_FALSE(found.facts[i].border);
      const auto first = static_cast<std::int64_t>(expected.pieces[i].first);
      const Index3 at =
          block.lo + Index3{first % size.x, first / size.x % size.y, first / size.x / size.y};
      EXPECT_EQ(found.facts[i].first, index_in(volume, at));
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) {
        const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        std::vector<std::uint32_t> labels_there;
        Index3 p;
        p[axis] = high ? size[axis] - 1 : 0;
        for (p[v] = 0; p[v] < size[v]; ++p[v])
          for (p[u] = 0; p[u] < size[u]; ++p[u])
            labels_there.push_back(expected.labels[index_in(size, p)]);
        const auto& face = found.faces[static_cast<std::size_t>(face_of(axis, high))];
        EXPECT_EQ(face_labels(face, size[u]), labels_there) << axis << high;
      }
  }
}

TEST(BlockPieces, AtTheVolumesBorder) {
  const BlockMask mask = mask_of(splat(5), [](Index3 p) { return p == Index3{4, 2, 2}; });
  BlockLabels labels;
  labels.find(mask);
  const auto found = [&](Index3 volume) {
    return describe_pieces(mask, labels, {{}, splat(5)}, volume);
  };
  const BlockPieces at_border = found(splat(5)), inside = found({6, 5, 5});
  EXPECT_TRUE(at_border.facts[0].border);
  EXPECT_EQ(at_border.open[0], 0);
  EXPECT_TRUE(at_border.faces[1].rows.empty());
  EXPECT_FALSE(inside.facts[0].border);
  EXPECT_EQ(inside.open[0], 1);
}

// Two columns of one layer that meet in the next: one group there, and both nodes go into it.
TEST(PieceJoin, GroupsMeetLate) {
  PieceJoin join({1, 1, 2});
  BlockFaces low, high;
  low[5] = {{0b101}, {0, 1}};
  high[4] = {{0b111}, {0}};
  const std::vector<PieceFacts> two{{5, 1, false}, {7, 0, true}}, one{{3, 9, false}};
  join.add(two, std::move(low));
  const auto none = [](std::uint32_t, const PieceFacts&) { ADD_FAILURE(); };
  const JoinedLayer first = join.end_layer(none);
  EXPECT_EQ(first.next, (std::vector<std::uint32_t>{0, 1}));
  join.add(one, std::move(high));
  std::vector<PieceFacts> complete;
  const JoinedLayer second =
      join.end_layer([&](std::uint32_t, const PieceFacts& facts) { complete.push_back(facts); });
  EXPECT_EQ(second.carried, 2U);
  EXPECT_EQ(second.groups, (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(complete, (std::vector<PieceFacts>{{15, 0, true}}));
  EXPECT_EQ(join.nodes(), 0U);
}

}  // namespace
}  // namespace voxweld
