// The kernels of QEFs against each other, and against the plain way.
#include <gtest/gtest.h>

#include <bit>
#include <span>

#include "tests/stages/plain_box_minimiser.h"
#include "tests/stages/qef_planes.h"
#include "tests/stages/with_all_kernels.h"

namespace voxweld::testing {
namespace {

// To the bit: batches are doubles without padding.
template <class Batch>
bool same_bits(const Batch& a, const Batch& b) {
  const auto bytes = [](const Batch& batch) { return std::as_bytes(std::span(&batch, 1)); };
  return std::ranges::equal(bytes(a), bytes(b));
}

TEST(QefKernels, EveryVectorUnitGivesTheSameBits) {
  std::vector<const QefKernels*> all = {qef_kernels_avx2(), qef_kernels_avx512()};
  std::mt19937 random(2);
  for (int round = 0; round < 500; ++round) {
    const auto sets = eight_sets([&](int) {
      return random_planes(random, 1 + static_cast<int>(random() % max_planes),
                           round % 3 == 0 ? 0 : 0.3);
    });
    const PlaneBatch batch = batch_of(sets);
    FactorBatch expected;
    SolutionBatch expected_x;
    qef_kernels_base().reduce(batch, expected);
    qef_kernels_base().solve(expected, 0.1, expected_x);
    ChildBatch children;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      std::size_t slot = 0;
      for (std::size_t octant = 0; octant < 8; ++octant)
        if (random() % 2 == 0)
          add_child(children, lane, slot++, octant, store_lane(expected, (lane + octant) % 8));
    }
    FactorBatch expected_merge;
    qef_kernels_base().merge(children, {0.5, 0.75, 1}, expected_merge);
    for (const QefKernels* kernels : all) {
      if (kernels == nullptr) continue;
      FactorBatch factor, merged;
      SolutionBatch x;
      kernels->reduce(batch, factor);
      kernels->solve(factor, 0.1, x);
      kernels->merge(children, {0.5, 0.75, 1}, merged);
      EXPECT_TRUE(same_bits(factor, expected)) << kernels->name;
      EXPECT_TRUE(same_bits(x, expected_x)) << kernels->name;
      EXPECT_TRUE(same_bits(merged, expected_merge)) << kernels->name;
    }
  }
}

// Few planes leave lines and planes of minima; boxes lie beside the minimiser, or far from it.
TEST(QefKernels, MinimisersInBoxesAreThoseOfThePlainWay) {
  with_all_kernels([] {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> end(-1, 1);
    int moved = 0;
    for (int round = 0; round < 2000; ++round) {
      const auto sets = eight_sets([&](int) {
        return random_planes(random, 1 + static_cast<int>(random() % 7), round % 3 == 0 ? 0 : 0.3);
      });
      FactorBatch factor;
      SolutionBatch before;
      qef_kernels().reduce(batch_of(sets), factor);
      qef_kernels().solve(factor, 0.1, before);
      SolutionBatch found = before, expected = before;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        LaneBox box;
        for (std::size_t a = 0; a < 3; ++a) {
          box.lo[a] = round % 2 == 0 ? -0.5 : end(random);
          box.hi[a] = round % 2 == 0 ? 0.5 : box.lo[a] + end(random) + 1;
        }
        const double threshold = round % 5 == 0 ? 0 : 0.1;
        constrain_lane(factor, lane, box, threshold, found);
        plain::constrain_lane(factor, lane, box, threshold, expected);
        moved += found.x[0][lane] != before.x[0][lane] ? 1 : 0;
      }
      ASSERT_TRUE(same_bits(found, expected)) << "round " << round;
    }
    EXPECT_GT(moved, 2000);
  });
}

// The plain way to the triangle: rows put in one after the other, each by a Givens rotation a column.
struct Givens {
  double r[3][4] = {}, squared_rest = 0;
  void add(std::array<double, 4> row) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = std::hypot(r[k][k], row[k]);
      if (h == 0) continue;
      const double c = r[k][k] / h, s = row[k] / h;
      for (std::size_t j = k; j < 4; ++j) {
        const double top = c * r[k][j] + s * row[j];
        row[j] = c * row[j] - s * r[k][j];
        r[k][j] = top;
      }
    }
    squared_rest += row[3] * row[3];
  }
  // The same sums of squares: where columns depend on each other triangles may differ, and which of
  // the right-hand side is beside them.
  void expect_is(const FactorBatch& factor, std::size_t lane, double bound) const {
    double f[3][4] = {};
    std::size_t at = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = k; j < 4; ++j) f[k][j] = factor.r[at++][lane];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j) {
        double theirs = i == 3 ? squared_rest : 0, ours = 0;
        if (i == 3) ours = factor.r[9][lane] * factor.r[9][lane];
        for (std::size_t k = 0; k < 3; ++k) {
          theirs += r[k][i] * r[k][j];
          ours += f[k][i] * f[k][j];
        }
        EXPECT_NEAR(ours, theirs, bound * std::max(1.0, std::abs(theirs))) << i << ' ' << j;
      }
  }
};

TEST(QefKernels, ReflectionsGiveWhatRotationsRowByRowGive) {
  std::mt19937 random(6);
  for (int round = 0; round < 300; ++round) {
    const double spread = std::array{0.0, 1e-9, 1e-3, 1.0}[static_cast<std::size_t>(round) % 4];
    const auto sets = eight_sets(
        [&](int) { return random_planes(random, 1 + static_cast<int>(random() % 12), spread); });
    const PlaneBatch batch = batch_of(sets);
    FactorBatch factor, merged;
    qef_kernels().reduce(batch, factor);
    ChildBatch children;
    std::array<Givens, lanes> all;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      Givens rows;
      for (std::size_t i = 0; i < sets[lane].normal.size(); ++i)
        rows.add({batch.plane[i][0][lane], batch.plane[i][1][lane], batch.plane[i][2][lane],
                  batch.plane[i][3][lane]});
      rows.expect_is(factor, lane, 1e-14);
      std::size_t slot = 0;
      for (std::size_t octant = 0; octant < 8; ++octant) {
        if (random() % 2 == 0) continue;
        const Qef qef = store_lane(factor, (lane + octant) % 8);
        add_child(children, lane, slot++, octant, qef);
        std::size_t at = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          std::array<double, 4> row{};
          for (std::size_t j = k; j < 4; ++j) row[j] = static_cast<double>(qef.r[at++]);
          for (std::size_t a = k; a < 3; ++a)
            row[3] += row[a] * 0.5 * ((octant >> a & 1) != 0 ? 1.0 : -1.0);
          all[lane].add(row);
        }
        all[lane].squared_rest += static_cast<double>(qef.r[9]) * static_cast<double>(qef.r[9]);
      }
    }
    qef_kernels().merge(children, {0.5, 0.5, 0.5}, merged);
    for (std::size_t lane = 0; lane < lanes; ++lane) all[lane].expect_is(merged, lane, 1e-13);
  }
}

// Which nodes share a batch depends on where bricks end: it may change no bit.
TEST(QefKernels, ALaneDoesNotDependOnTheOthers) {
  std::mt19937 random(7);
  const auto lane_of = [](const auto& values, std::size_t lane) {
    std::vector<std::uint64_t> bits;
    bits.reserve(values.size());
    for (const LaneArray& value : values) bits.push_back(std::bit_cast<std::uint64_t>(value[lane]));
    return bits;
  };
  for (int round = 0; round < 300; ++round) {
    const auto sets = eight_sets([&](int) {
      return random_planes(random, 1 + static_cast<int>(random() % max_planes),
                           round % 3 == 0 ? 0 : 0.3);
    });
    FactorBatch together, merged;
    SolutionBatch solved, merged_solved;
    qef_kernels().reduce(batch_of(sets), together);
    qef_kernels().solve(together, 0.1, solved);
    ChildBatch children;
    std::array<ChildBatch, lanes> single;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      std::size_t slot = 0;
      for (std::size_t octant = 0; octant < 8; ++octant) {
        if (random() % 2 == 0) continue;
        const Qef qef = store_lane(together, (lane + octant) % 8);
        add_child(children, lane, slot, octant, qef);
        add_child(single[lane], 0, slot++, octant, qef);
      }
    }
    qef_kernels().merge(children, {0.5, 0.75, 1}, merged);
    qef_kernels().solve(merged, 0.1, merged_solved);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      FactorBatch alone;
      SolutionBatch alone_solved;
      qef_kernels().reduce(batch_of({sets[lane]}), alone);
      qef_kernels().solve(alone, 0.1, alone_solved);
      EXPECT_EQ(lane_of(alone.r, 0), lane_of(together.r, lane));
      EXPECT_EQ(lane_of(alone_solved.x, 0), lane_of(solved.x, lane));
      qef_kernels().merge(single[lane], {0.5, 0.75, 1}, alone);
      qef_kernels().solve(alone, 0.1, alone_solved);
      EXPECT_EQ(lane_of(alone.r, 0), lane_of(merged.r, lane));
      EXPECT_EQ(lane_of(alone.mass, 0), lane_of(merged.mass, lane));
      EXPECT_EQ(lane_of(alone_solved.x, 0), lane_of(merged_solved.x, lane));
    }
  }
}

}  // namespace
}  // namespace voxweld::testing
