#include "pipeline/phantom/phantom_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "storage/support/error.h"
#include "tests/support/reference_dual.h"
#include "tests/support/sign_grid.h"

namespace voxweld {
namespace {

std::vector<std::byte> read(const SampleSource& source, const Box3& box) {
  std::vector<std::byte> data(static_cast<std::size_t>(box.count()) *
                              sample_bytes(source.info().type));
  source.read(box, data.data());
  return data;
}

TEST(PhantomSource, SaysWhatItIs) {
  const PhantomSource source({.kind = PhantomKind::part,
                              .size = 50,
                              .type = SampleType::u8,
                              .spacing = {0.5, 0.5, 2},
                              .unit = "mm"});
  EXPECT_EQ(source.info().geometry.size, splat(50));
  EXPECT_EQ(source.info().geometry.spacing, (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(source.info().geometry.unit, "mm");
  EXPECT_EQ(source.info().type, SampleType::u8);
  EXPECT_EQ(source.info().access, Access::box);
}

TEST(PhantomSource, RefusesWhatCannotBe) {
  EXPECT_THROW(PhantomSource({.size = 0}), InputError);
  EXPECT_THROW(PhantomSource({.type = SampleType::i32}), InputError);
  EXPECT_THROW(PhantomSource({.spacing = {1, 0, 1}}), InputError);
  EXPECT_THROW(PhantomSource({.spacing = {1, 1, std::nan("")}}), InputError);
  EXPECT_THROW(PhantomSource({.unit = "m\"m"}), InputError);
  EXPECT_THROW(PhantomSource({.kind = PhantomKind::labels, .type = SampleType::f32}), InputError);
}

// Boxes larger than a block, across blocks, and single samples: the whole's samples.
TEST(PhantomSource, BoxesEqualTheWhole) {
  const std::int64_t n = 45;
  for (const PhantomKindInfo& info : phantom_kinds())
    for (const SampleType type : {SampleType::u8, SampleType::u16, SampleType::f32}) {
      if (holds_labels(info.kind) && type == SampleType::f32) continue;
      const PhantomSource source({.kind = info.kind, .size = n, .type = type, .seed = 3});
      const auto bytes = sample_bytes(type);
      const auto whole = read(source, {{0, 0, 0}, splat(n)});
      for (const Box3& box : {Box3{{0, 3, 1}, {45, 20, 18}}, Box3{{17, 1, 40}, {18, 45, 45}},
                              Box3{{44, 44, 44}, {45, 45, 45}}, Box3{{5, 6, 7}, {29, 30, 31}}}) {
        const auto part = read(source, box);
        const Index3 size = box.size();
        for (std::int64_t z = 0; z < size.z; ++z)
          for (std::int64_t y = 0; y < size.y; ++y) {
            const auto from =
                static_cast<std::size_t>(((z + box.lo.z) * n + y + box.lo.y) * n + box.lo.x);
            const auto to = static_cast<std::size_t>((z * size.y + y) * size.x);
            ASSERT_EQ(std::memcmp(whole.data() + from * bytes, part.data() + to * bytes,
                                  static_cast<std::size_t>(size.x) * bytes),
                      0)
                << info.name << ' ' << sample_type_name(type);
          }
      }
    }
}

// A sample computed by hand: the gyroid at the centre.
TEST(PhantomSource, SampleByHand) {
  const PhantomSource source({.kind = PhantomKind::gyroid, .size = 121});
  const auto data = read(source, {{60, 60, 60}, {61, 61, 61}});
  std::uint16_t sample = 0;
  std::memcpy(&sample, data.data(), sizeof sample);
  const double k = 2 * 3.14159265358979324 / 12.1;
  const double d = (std::sin(0.3) * std::cos(0.7) + std::sin(0.7) * std::cos(1.1) +
                    std::sin(1.1) * std::cos(0.3)) /
                   (1.4 * k);
  EXPECT_EQ(sample, static_cast<int>(std::floor(32768 + 2048 * d)));
}

// Every kind but noise is a closed body or void at its border; small volumes work too.
TEST(PhantomSource, BorderIsOutside) {
  for (const PhantomKindInfo& info : phantom_kinds()) {
    if (info.kind == PhantomKind::noise) continue;
    const std::int64_t n = 40;
    const PhantomSource source({.kind = info.kind, .size = n});
    const auto data = read(source, {{0, 0, 0}, {n, n, 1}});
    for (std::size_t i = 0; i < data.size(); i += 2) {
      std::uint16_t sample = 0;
      std::memcpy(&sample, data.data() + i, sizeof sample);
      if (holds_labels(info.kind))
        ASSERT_EQ(sample, 0);
      else
        ASSERT_GT(sample, 32767) << info.name;
    }
  }
}

// A uniform mesh of each body has the shape its name promises.
TEST(PhantomSource, BodiesHaveTheirTopology) {
  const auto summary = [](PhantomKind kind, std::int64_t n) {
    const PhantomSource source({.kind = kind, .size = n});
    const auto data = read(source, {{0, 0, 0}, splat(n)});
    std::vector<std::uint16_t> samples(data.size() / 2);
    std::memcpy(samples.data(), data.data(), data.size());
    const double isovalue = *phantom_isovalue(kind, SampleType::u16);
    const auto grid = testing::signs_of<std::uint16_t>(
        splat(n), samples, [=](std::uint16_t v) { return testing::inside_below(v, isovalue); });
    return testing::summarize(testing::reference_dual(grid).triangles());
  };
  EXPECT_EQ(summary(PhantomKind::sphere, 20), (testing::MeshSummary{.components = 1, .euler = 2}));
  EXPECT_EQ(summary(PhantomKind::torus, 24), (testing::MeshSummary{.components = 1, .euler = 0}));
  EXPECT_TRUE(summary(PhantomKind::part, 40).sound());
  EXPECT_TRUE(summary(PhantomKind::noise, 12).sound());
}

TEST(PhantomSource, OneSampleWorks) {
  for (const PhantomKindInfo& info : phantom_kinds()) {
    const PhantomSource source({.kind = info.kind, .size = 1});
    EXPECT_EQ(read(source, {{0, 0, 0}, {1, 1, 1}}).size(), 2u);
  }
}

}  // namespace
}  // namespace voxweld
