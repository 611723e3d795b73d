// The minimiser of a QEF over a box, face by face and edge by edge: what constrain_lane is compared with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/contouring/qef.h"

namespace voxweld::testing::plain {

// A QEF in plain form for the rare minimiser outside its cell.
struct Plain {
  double r[3][3]{};  // columns of the factor: r[column][row]
  double b[3]{};
  double rho2 = 0;
  double mass[3]{};
};

inline Plain plain_lane(const FactorBatch& f, std::size_t lane) {
  const auto at = [&](std::size_t i) { return f.r[i][lane]; };
  Plain p;
  p.r[0][0] = at(0);
  p.r[1][0] = at(1);
  p.r[2][0] = at(2);
  p.r[1][1] = at(4);
  p.r[2][1] = at(5);
  p.r[2][2] = at(7);
  p.b[0] = at(3);
  p.b[1] = at(6);
  p.b[2] = at(8);
  p.rho2 = at(9) * at(9);
  for (std::size_t a = 0; a < 3; ++a) p.mass[a] = f.mass[a][lane];
  return p;
}

inline double energy_at(const Plain& p, const double* x) {
  double sum = p.rho2;
  for (int i = 0; i < 3; ++i) {
    const double e = p.r[0][i] * x[0] + p.r[1][i] * x[1] + p.r[2][i] * x[2] - p.b[i];
    sum += e * e;
  }
  return sum;
}

inline double squared(const double* v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}
inline double inner(const double* u, const double* v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

// The right-hand side with the given coordinates put in and the others at zero.
inline void residual_rhs(const Plain& p, const double* x, double* c) {
  for (int i = 0; i < 3; ++i)
    c[i] = p.b[i] - p.r[0][i] * x[0] - p.r[1][i] * x[1] - p.r[2][i] * x[2];
}

// Minimises over axes u and v with the third coordinate fixed in x; x[u], x[v] enter as the start
// (mass point) and leave as the solution. Columns are made orthogonal by one exact rotation.
inline void solve_face(const Plain& p, int u, int v, double cut, double* x) {
  double c[3];
  residual_rhs(p, x, c);
  double wu[3], wv[3];
  std::copy(p.r[u], p.r[u] + 3, wu);
  std::copy(p.r[v], p.r[v] + 3, wv);
  const double d = squared(wv) - squared(wu), g = 2 * inner(wu, wv);
  const double divisor = std::abs(d) + std::sqrt(d * d + g * g);
  const double t = divisor > 0 ? (d < 0 ? -g : g) / divisor : 0;
  const double cosine = 1 / std::sqrt(1 + t * t), sine = cosine * t;
  for (int i = 0; i < 3; ++i) {
    const double a = wu[i], b = wv[i];
    wu[i] = cosine * a - sine * b;
    wv[i] = sine * a + cosine * b;
  }
  const double su = squared(wu), sv = squared(wv);
  const double yu = su > cut ? inner(wu, c) / su : 0, yv = sv > cut ? inner(wv, c) / sv : 0;
  x[u] += cosine * yu + sine * yv;
  x[v] += cosine * yv - sine * yu;
}

inline void solve_edge(const Plain& p, int axis, double cut, double* x) {
  double c[3];
  residual_rhs(p, x, c);
  const double s = squared(p.r[axis]);
  if (s > cut) x[axis] += inner(p.r[axis], c) / s;
}

// Where planes leave a line of minima on the box's border, its ends and what lies between them
// differ by rounding alone. Then the one nearest the mass point is taken: an end can lie far from
// all crossings, outside the surface.
class Candidates {
 public:
  explicit Candidates(const Plain& p) : p_(p) {}
  void offer(const double* x) {
    Candidate& to = all_[count_++];
    to.energy = energy_at(p_, x);
    for (int a = 0; a < 3; ++a) {
      to.x[a] = x[a];
      to.from_mass += (x[a] - p_.mass[a]) * (x[a] - p_.mass[a]);
    }
  }
  struct Candidate {
    double x[3]{};
    double energy = 0, from_mass = 0;
  };
  // slack: the change of distance, the root of an energy, that rounding makes.
  const Candidate& best(double slack) const {
    const Candidate* best = all_.data();
    for (std::size_t i = 1; i < count_; ++i)
      if (all_[i].energy < best->energy) best = &all_[i];
    const double limit = std::sqrt(best->energy) + slack, equal = limit * limit;
    for (std::size_t i = 0; i < count_; ++i)
      if (all_[i].energy <= equal && all_[i].from_mass < best->from_mass) best = &all_[i];
    return *best;
  }

 private:
  const Plain& p_;
  std::array<Candidate, 18> all_{};  // six faces, twelve edges
  std::size_t count_ = 0;
};

inline void constrain_lane(const FactorBatch& factor, std::size_t lane, const LaneBox& box,
                           double threshold, SolutionBatch& solution) {
  bool inside = true;
  for (int a = 0; a < 3; ++a)
    inside = inside && box.contains(a, solution.x[static_cast<std::size_t>(a)][lane]);
  if (inside) return;

  const Plain p = plain_lane(factor, lane);
  // The cut must not depend on which face is tried: it is that of the largest column norm, within a
  // factor of sqrt(3) of the largest singular value.
  double largest = 0;
  for (const auto& column : p.r) largest = std::max(largest, squared(column));
  const double cut = largest * threshold * threshold;
  const auto clamped_mass = [&](int axis) { return box.clamp(axis, p.mass[axis]); };
  const auto end = [&](int axis, bool high) {
    return (high ? box.hi : box.lo)[static_cast<std::size_t>(axis)];
  };

  Candidates candidates(p);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      double x[3];
      x[axis] = end(axis, high);
      x[u] = clamped_mass(u);
      x[v] = clamped_mass(v);
      solve_face(p, u, v, cut, x);
      if (box.contains(u, x[u]) && box.contains(v, x[v])) candidates.offer(x);
    }
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      double x[3];
      x[axis] = clamped_mass(axis);
      x[u] = end(u, (corner & 1) != 0);
      x[v] = end(v, (corner & 2) != 0);
      solve_edge(p, axis, cut, x);
      x[axis] = box.clamp(axis, x[axis]);
      candidates.offer(x);
    }
  double far[3];
  for (std::size_t a = 0; a < 3; ++a) far[a] = std::max(std::abs(box.lo[a]), std::abs(box.hi[a]));
  const double slack = 1e-5 * std::sqrt(factor.planes[lane] * squared(far));
  const Candidates::Candidate& best = candidates.best(slack);
  for (std::size_t a = 0; a < 3; ++a) solution.x[a][lane] = best.x[a];
  solution.energy[lane] = best.energy;
}

}  // namespace voxweld::testing::plain
