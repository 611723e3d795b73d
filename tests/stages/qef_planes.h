// QEFs to put together in tests of them: planes drawn at random, and batches of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "stages/contouring/qef.h"

namespace voxweld::testing {

struct Planes {
  std::vector<std::array<double, 3>> normal, point;
  double energy(const std::array<double, 3>& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < normal.size(); ++i) {
      double d = 0;
      for (std::size_t a = 0; a < 3; ++a) d += normal[i][a] * (x[a] - point[i][a]);
      sum += d * d;
    }
    return sum;
  }
};

inline Planes random_planes(std::mt19937& random, int count, double spread) {
  std::uniform_real_distribution<double> u(-1, 1);
  Planes planes;
  const std::array<double, 3> main{u(random), u(random), u(random)};
  for (int i = 0; i < count; ++i) {
    std::array<double, 3> n;
    double length = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      n[a] = main[a] + spread * u(random);
      length += n[a] * n[a];
    }
    for (double& v : n) v /= std::sqrt(length);
    planes.normal.push_back(n);
    planes.point.push_back({0.5 * u(random), 0.5 * u(random), 0.5 * u(random)});
  }
  return planes;
}

inline PlaneBatch batch_of(const std::vector<Planes>& sets) {
  PlaneBatch batch;
  for (std::size_t lane = 0; lane < sets.size(); ++lane) {
    const Planes& p = sets[lane];
    batch.rows = std::max(batch.rows, static_cast<int>(p.normal.size()));
    for (std::size_t i = 0; i < p.normal.size(); ++i) {
      double b = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        batch.plane[i][a][lane] = p.normal[i][a];
        b += p.normal[i][a] * p.point[i][a];
        batch.mass[a][lane] += p.point[i][a] / static_cast<double>(p.normal.size());
      }
      batch.plane[i][3][lane] = b;
    }
  }
  return batch;
}

// One QEF as a child of this octant in one lane.
inline void add_child(ChildBatch& children, std::size_t lane, std::size_t slot, std::size_t octant,
                      const Qef& qef) {
  ChildValues& values = children.child[slot];
  for (std::size_t i = 0; i < 10; ++i) values[i][lane] = qef.r[i];
  for (std::size_t a = 0; a < 3; ++a) {
    values[10 + a][lane] = qef.mass[a];
    values[13 + a][lane] = (octant >> a & 1) != 0 ? 1.0F : -1.0F;
  }
  children.slots = std::max(children.slots, slot + 1);
}

template <class F>
std::vector<Planes> eight_sets(F&& planes_of) {
  std::vector<Planes> sets(lanes);
  for (int lane = 0; lane < 8; ++lane) sets[static_cast<std::size_t>(lane)] = planes_of(lane);
  return sets;
}

}  // namespace voxweld::testing
