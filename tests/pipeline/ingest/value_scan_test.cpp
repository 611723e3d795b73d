#include "pipeline/info/value_scan.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace voxweld {
namespace {

// Few values, so that histograms differ where a sample is counted in the wrong place.
class SmallSource final : public SampleSource {
 public:
  SmallSource(Index3 size, Access access, Index3 chunk = {1, 1, 1}) {
    info_.format = "small";
    info_.type = SampleType::u8;
    info_.geometry.size = size;
    info_.access = access;
    info_.chunk = chunk;
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    each_index(box, [&](Index3 at) {
      *out++ = static_cast<std::byte>((at.x * 31 + at.y * 17 + at.z * 7) % 251);
    });
  }

 private:
  VolumeInfo info_;
};

RC_GTEST_PROP(ValueScan, IsTheSameChunkByChunkAndInBands, ()) {
  const auto sides = rc::gen::inRange<std::int64_t>(1, 12);
  const Index3 size{*sides, *sides, *sides}, chunk{*sides, *sides, *sides};
  std::int64_t samples = 0;
  ScanHooks hooks;
  hooks.samples = [&](const Box3& piece, std::span<const std::byte> bytes) {
    RC_ASSERT(static_cast<std::int64_t>(bytes.size()) == piece.count());
    samples += piece.count();
  };
  const ScanResult bands = scan_in_order(SmallSource(size, Access::slice), {});
  const ScanResult chunks = scan_in_order(SmallSource(size, Access::chunks, chunk), hooks);
  RC_ASSERT(samples == size.x * size.y * size.z);
  RC_ASSERT(chunks.histogram == bands.histogram);
  RC_ASSERT(chunks.border == bands.border);
  RC_ASSERT(chunks.range.lo == bands.range.lo && chunks.range.hi == bands.range.hi);
}

TEST(ValueScan, BorderIsTheOutermostLayer) {
  const ScanResult scan = scan_in_order(SmallSource({5, 4, 3}, Access::chunks, {2, 3, 2}), {});
  std::uint64_t border = 0;
  for (const HistogramBin& bin : scan.border.bins) border += bin.count;
  EXPECT_EQ(border, 5U * 4 * 3 - 3 * 2 * 1);
}

}  // namespace
}  // namespace voxweld
