#include "pipeline/report/volume_samples.h"

#include <gtest/gtest.h>

#include <cstring>

namespace voxweld {
namespace {

// Sample (x, y, z) is x + 100 y + 10000 z, as read by a source of that kind.
class Numbered final : public SampleSource {
 public:
  Numbered(Index3 size, VolumeInfo like) : info_(std::move(like)) {
    info_.type = SampleType::i32;
    info_.geometry.size = size;
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE((Box3{{}, info_.geometry.size}.contains(box)));
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y)
        for (std::int64_t x = box.lo.x; x < box.hi.x; ++x, out += sizeof(std::int32_t)) {
          const auto value = static_cast<std::int32_t>(x + 100 * y + 10000 * z) - below_;
          std::memcpy(out, &value, sizeof value);
        }
    ++reads;
    samples += box.count();
  }

  mutable std::int64_t reads = 0, samples = 0;
  std::int32_t below_ = 0;

 private:
  VolumeInfo info_;
};

void expect_slices(const SampleSurvey& found, Index3 size) {
  for (int i = 0; i < 3; ++i) {
    const Slice& slice = found.slices[static_cast<std::size_t>(i)];
    const int axis = 2 - i;
    EXPECT_EQ(slice.axis, axis);
    EXPECT_EQ(slice.index, size[axis] / 2);
    EXPECT_EQ(slice.columns.axis, axis == 0 ? 1 : 0);
    EXPECT_EQ(slice.rows.axis, axis == 2 ? 1 : 2);
    for (std::int64_t row = 0; row < slice.rows.count; ++row)
      for (std::int64_t column = 0; column < slice.columns.count; ++column) {
        Index3 at;
        at[axis] = slice.index;
        at[slice.columns.axis] = slice.columns.at(column);
        at[slice.rows.axis] = slice.rows.at(row);
        ASSERT_EQ(slice.values[slice.place(column, row)],
                  static_cast<double>(at.x + 100 * at.y + 10000 * at.z))
            << axis << " " << column << " " << row;
      }
  }
}

TEST(VolumeSamples, ASideIsSampledEvenly) {
  for (std::int64_t size = 1; size < 60; ++size)
    for (int most = 1; most < 20; ++most) {
      const SampledSide side = sampled_side(1, size, most);
      EXPECT_EQ(side.axis, 1);
      EXPECT_LE(side.count, most);
      EXPECT_GE(side.first, 0);
      const std::int64_t behind = size - 1 - side.at(side.count - 1);
      EXPECT_GE(behind, side.first);
      EXPECT_LE(behind, side.first + 1);
      EXPECT_LT(behind, side.step);
      if (size <= most) {
        EXPECT_EQ(side.step, 1);
      }
    }
}

TEST(VolumeSamples, AreTheSameHoweverTheVolumeIsRead) {
  const Index3 size{40, 31, 23};
  for (const int side : {7, 16, 100})
    for (const Access access :
         {Access::box, Access::chunks, Access::rows, Access::slice, Access::stream})
      for (const Index3 chunk : {Index3{1, 1, 1}, Index3{8, 8, 8}, Index3{40, 31, 2}})
        for (const bool row_major : {false, true}) {
          VolumeInfo info;
          info.access = access;
          if (access == Access::box || access == Access::chunks) info.chunk = chunk;
          info.row_major = row_major && access == Access::box;
          const Numbered source(size, info);
          SampleRequest request;
          request.side = side;
          const SampleSurvey found = look_at_samples(source, request);
          expect_slices(found, size);
          EXPECT_EQ(found.counted, 40u * 31 * 23);
        }
}

TEST(VolumeSamples, ChunksMayBeginBeforeTheVolume) {
  VolumeInfo info;
  info.chunk = {8, 8, 8};
  info.chunk_first = {-3, -5, -7};
  const Index3 size{40, 31, 23};
  const Numbered source(size, info);
  expect_slices(look_at_samples(source, {}), size);
}

TEST(VolumeSamples, ReadNotMuchOfALargeVolume) {
  const Index3 size{200, 200, 200};
  VolumeInfo info;
  info.row_major = true;
  const Numbered source(size, info);
  SampleRequest request;
  request.side = 50;
  request.most = 20000;
  const SampleSurvey found = look_at_samples(source, request);
  expect_slices(found, size);
  EXPECT_LE(found.counted, 20000u);
  EXPECT_GE(found.counted, 10000u);
  // Two slices by whole rows, one by single samples.
  EXPECT_EQ(source.samples, 2 * 50 * 200 + 50 * 50 + static_cast<std::int64_t>(found.counted));
}

TEST(VolumeSamples, AreRealValues) {
  VolumeInfo info;
  info.scale = {2, -5};
  const Numbered source({3, 3, 3}, info);
  EXPECT_EQ(look_at_samples(source, {}).slices[0].values[0], 2 * 10000 - 5);
}

TEST(VolumeSamples, LabelsAreAsStored) {
  VolumeInfo info;
  info.scale = {2, -5};
  Numbered source({3, 3, 3}, info);
  source.below_ = 10001;
  SampleRequest request;
  request.labels = true;
  const SampleSurvey found = look_at_samples(source, request);
  EXPECT_TRUE(found.slices[0].values.empty());
  EXPECT_EQ(found.slices[0].labels[0], exterior);  // -1
  EXPECT_EQ(found.slices[0].labels[1], 0u);
  EXPECT_EQ(found.slices[0].labels[2], 1u);
}

}  // namespace
}  // namespace voxweld
