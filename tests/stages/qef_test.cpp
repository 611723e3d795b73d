#include <gtest/gtest.h>

#include "stages/contouring/node_solver.h"
#include "tests/stages/qef_planes.h"

namespace voxweld::testing {
namespace {

double norm(Vec3 v) {
  return std::sqrt(dot(v, v));
}
Vec3 unit(Vec3 v) {
  return v * (1 / norm(v));
}

LaneBox around(Vec3 half) {
  return {{-half.x, -half.y, -half.z}, {half.x, half.y, half.z}};
}

TEST(Qef, FactorHasTheEnergyOfThePlanes) {
  std::mt19937 random(1);
  const auto sets = eight_sets([&](int lane) { return random_planes(random, 3 + lane, 1); });
  FactorBatch factor;
  qef_kernels_base().reduce(batch_of(sets), factor);
  SolutionBatch solution;
  qef_kernels_base().solve(factor, 0, solution);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    std::array<double, 3> x;
    for (std::size_t a = 0; a < 3; ++a) x[a] = solution.x[a][lane];
    EXPECT_NEAR(solution.energy[lane], sets[lane].energy(x), 1e-12);
    EXPECT_NEAR(factor.planes[lane], static_cast<double>(sets[lane].normal.size()), 1e-9);
    for (std::size_t a = 0; a < 3; ++a)  // a minimum: no step lowers the energy
      for (const double step : {-1e-4, 1e-4}) {
        auto moved = x;
        moved[a] += step;
        EXPECT_GE(sets[lane].energy(moved), solution.energy[lane] - 1e-13);
      }
  }
}

TEST(Qef, FlatSetsTakeThePointNearestTheMassPoint) {
  Planes flat;
  for (int i = 0; i < 4; ++i) {
    flat.normal.push_back({0, 0, 1});
    flat.point.push_back({i * 0.1, -0.2, 0.25});
  }
  FactorBatch factor;
  SolutionBatch solution;
  qef_kernels_base().reduce(batch_of({flat}), factor);
  qef_kernels_base().solve(factor, 0.1, solution);
  EXPECT_NEAR(solution.x[0][0], 0.15, 1e-12);
  EXPECT_NEAR(solution.x[1][0], -0.2, 1e-12);
  EXPECT_NEAR(solution.x[2][0], 0.25, 1e-12);
  EXPECT_NEAR(solution.energy[0], 0, 1e-20);
}

TEST(Qef, MergedChildrenHaveTheEnergyOfAllTheirPlanes) {
  std::mt19937 random(3);
  const auto sets = eight_sets([&](int) { return random_planes(random, 5, 1); });
  FactorBatch factor;
  qef_kernels().reduce(batch_of(sets), factor);
  ChildBatch children;
  for (std::size_t octant = 0; octant < 8; ++octant)
    add_child(children, 0, octant, octant, store_lane(factor, octant));
  FactorBatch merged;
  SolutionBatch solution;
  qef_kernels().merge(children, {0.5, 0.5, 0.5}, merged);
  qef_kernels().solve(merged, 0, solution);
  std::array<double, 3> x, mass{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = solution.x[a][0];
  double energy = 0;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    std::array<double, 3> local = x;
    for (std::size_t a = 0; a < 3; ++a) {
      const double centre = (octant >> a & 1) != 0 ? 0.5 : -0.5;
      local[a] -= centre;
      for (const auto& p : sets[octant].point) mass[a] += (p[a] + centre) / 40;
    }
    energy += sets[octant].energy(local);
  }
  EXPECT_NEAR(solution.energy[0], energy, 1e-5);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(merged.mass[a][0], mass[a], 1e-6);
}

TEST(Qef, ConstrainedMinimumIsTheBestOfAFineSearch) {
  std::mt19937 random(4);
  int outside = 0;
  for (int round = 0; round < 200; ++round) {
    const Planes planes = random_planes(random, 4, 0.4);
    FactorBatch factor;
    SolutionBatch solution;
    qef_kernels().reduce(batch_of({planes}), factor);
    qef_kernels().solve(factor, 0, solution);
    const Vec3 half{0.5, 0.4, 0.6};
    const SolutionBatch before = solution;
    constrain_lane(factor, 0, around(half), 0, solution);
    outside += before.x[0][0] != solution.x[0][0] ? 1 : 0;
    double best = 1e300;
    for (int i = -20; i <= 20; ++i)
      for (int j = -20; j <= 20; ++j)
        for (int k = -20; k <= 20; ++k)
          best = std::min(best, planes.energy({i * half.x / 20, j * half.y / 20, k * half.z / 20}));
    EXPECT_LE(solution.energy[0], best + 1e-9);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_LE(std::abs(solution.x[a][0]), half[static_cast<int>(a)]);
  }
  EXPECT_GT(outside, 50);
}

// Two planes meet in a line. Where it passes through the box, but not at its point nearest the mass
// point, both its ends have no energy at all.
TEST(Qef, OfALineOfMinimaTheEndNearestTheMassPointIsTaken) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  const Vec3 half{0.5, 0.5, 0.5};
  int of_two_ends = 0;
  for (int round = 0; round < 3000; ++round) {
    const Vec3 through{u(random), u(random), u(random)};
    Vec3 normal[2];
    for (Vec3& n : normal) n = unit(Vec3{u(random), u(random), u(random)});
    const Vec3 along = unit(cross(normal[0], normal[1]));
    Planes planes;
    for (int i = 0; i < 4; ++i) {  // crossings gathered at one place, away from the line
      const Vec3 n = normal[i % 2];
      const Vec3 at = through + along * 1.5 + cross(n, along) * (0.1 * u(random));
      planes.normal.push_back({n.x, n.y, n.z});
      planes.point.push_back({at.x, at.y, at.z});
    }
    FactorBatch factor;
    SolutionBatch solution;
    qef_kernels().reduce(batch_of({planes}), factor);
    load_lane(store_lane(factor, 0), 0, factor);  // with the rounding of an artifact
    qef_kernels().solve(factor, 1e-4, solution);
    constrain_lane(factor, 0, around(half), 1e-4, solution);
    const Vec3 x{solution.x[0][0], solution.x[1][0], solution.x[2][0]};
    // Where the line leaves the box towards the crossings.
    double end = 1e9;
    for (int a = 0; a < 3; ++a)
      if (along[a] != 0)
        end = std::min(end, (std::copysign(0.5, along[a]) - through[a]) / along[a]);
    if (norm(cross(normal[0], normal[1])) < 0.2) continue;
    ++of_two_ends;
    EXPECT_LT(norm(x - (through + along * end)), 1e-3) << round;
  }
  EXPECT_GT(of_two_ends, 2000);
}

TEST(CellExtent, OfAParentIsThatOfItsChildrenRoundedOutwards) {
  CellExtent one;  // a cell of its own
  for (int level = 1; level <= 8; ++level) one = one.in_parent(0b101);
  EXPECT_EQ(one.lo, (std::array<std::uint8_t, 3>{255, 0, 255}));
  EXPECT_EQ(one.hi, (std::array<std::uint8_t, 3>{255, 0, 255}));
  one = one.in_parent(0b010);  // half of a 256th on each axis
  EXPECT_EQ(one.lo, (std::array<std::uint8_t, 3>{127, 128, 127}));
  EXPECT_EQ(one.hi, (std::array<std::uint8_t, 3>{127, 128, 127}));
  CellExtent both = one;
  both.join(CellExtent{{10, 200, 127}, {20, 210, 130}});
  EXPECT_EQ(both.lo, (std::array<std::uint8_t, 3>{10, 128, 127}));
  EXPECT_EQ(both.hi, (std::array<std::uint8_t, 3>{127, 210, 130}));
}

// Three planes through one cell that meet seven cells away, inside of the node of 16 cells a side that
// has nothing else: the vertex stays with the cell.
TEST(NodeSolver, AVertexStaysWithinACellOfTheCellsItStandsFor) {
  const Vec3 meet{7, 6.5, 7.25};
  std::array<HermitePlane, 3> planes;
  const std::array<Vec3, 3> near{Vec3{0.2, 0, 0}, Vec3{0, -0.3, 0.1}, Vec3{0.1, 0.2, -0.2}};
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3 axis{};
    axis[static_cast<int>(i)] = 1;
    const Vec3 n = unit(cross(meet - near[i], axis)), p = near[i];
    planes[i] = {{n.x, n.y, n.z}, {p.x, p.y, p.z}};
  }
  ContourParameters parameters;
  parameters.simplify.singular_threshold = 1e-4;
  NodeSolver solver(parameters);
  solver.clear_planes();
  solver.set_planes(0, {planes.data(), 3});
  solver.reduce();
  Qef qef = solver.qef(0);
  for (int level = 1; level <= 4; ++level) {
    solver.clear_children();
    solver.set_child(0, 0, qef);
    solver.merge(level - 1);
    qef = solver.qef(0);
  }
  solver.solve(4, 1);
  const auto inside = solver.solution(0).offset;
  for (const float offset : inside) {  // its cell is the lowest, from -8 to -7
    EXPECT_GE(offset, -8);
    EXPECT_LE(offset, -6);
  }
  // Loaded as a record is, and added to another of the same node whose cells are all over it.
  solver.load(0, qef);
  solver.solve(4, 1);
  EXPECT_EQ(solver.solution(0).offset, inside);
  Qef wide = qef;
  wide.extent = {};
  solver.clear_children();
  solver.set_part(0, qef);
  solver.set_part(0, wide);
  solver.merge_in_place();
  solver.solve(4, 1);
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(static_cast<double>(solver.solution(0).offset[static_cast<std::size_t>(a)]),
                meet[a] - 7.5, 1e-3);
}

}  // namespace
}  // namespace voxweld::testing
