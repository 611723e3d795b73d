#include "stages/contouring/qef_normal.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

double as_float(double v) {
  return static_cast<double>(static_cast<float>(v));
}

// Adds the outer product of (n, b) to the ten sums, each rounded to float.
void add_plane(const std::array<double, 4>& row, std::size_t lane, FactorBatch& out) {
  std::size_t i = 0;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = r; c < 4; ++c, ++i)
      out.r[i][lane] = as_float(out.r[i][lane] + as_float(row[r] * row[c]));
}

// Cyclic Jacobi on a symmetric 3x3; columns of v are the eigenvectors.
void eigen(double a[3][3], double v[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) v[i][j] = i == j ? 1 : 0;
  for (int sweep = 0; sweep < 6; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        const double d = a[q][q] - a[p][p], g = 2 * a[p][q];
        const double divisor = std::abs(d) + std::sqrt(d * d + g * g);
        if (!(divisor > 0)) continue;
        const double t = (d < 0 ? -g : g) / divisor;
        const double c = 1 / std::sqrt(1 + t * t), s = c * t;
        for (int k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k], vp = v[k][p], vq = v[k][q];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
}

}  // namespace

void reduce_normal(const PlaneBatch& batch, const std::array<Vec3, lanes>& centre,
                   FactorBatch& out) {
  out = FactorBatch{};
  out.mass = batch.mass;
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t i = 0; i < static_cast<std::size_t>(batch.rows); ++i) {
      const auto& plane = batch.plane[i];
      const Vec3 n{plane[0][lane], plane[1][lane], plane[2][lane]};
      if (n == Vec3{}) continue;
      add_plane({n.x, n.y, n.z, plane[3][lane] + dot(n, centre[lane])}, lane, out);
      out.planes[lane] += std::round(dot(n, n));  // the plane's weight
    }
}

void merge_normal(const ChildBatch& batch, Vec3 half, FactorBatch& out) {
  out = FactorBatch{};
  for (std::size_t slot = 0; slot < batch.slots; ++slot) {
    const ChildValues& child = batch.child[slot];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double planes = static_cast<double>(child[0][lane]) +
                            static_cast<double>(child[4][lane]) +
                            static_cast<double>(child[7][lane]);
      for (std::size_t i = 0; i < 10; ++i)
        out.r[i][lane] = as_float(out.r[i][lane] + static_cast<double>(child[i][lane]));
      for (std::size_t a = 0; a < 3; ++a)
        out.mass[a][lane] +=
            planes * (static_cast<double>(child[10 + a][lane]) +
                      static_cast<double>(child[13 + a][lane]) * half[static_cast<int>(a)]);
      out.planes[lane] += planes;
    }
  }
  for (std::size_t lane = 0; lane < lanes; ++lane)
    for (std::size_t a = 0; a < 3; ++a)
      if (out.planes[lane] > 0) out.mass[a][lane] /= out.planes[lane];
}

void solve_normal(const FactorBatch& factor, const std::array<Vec3, lanes>& centre,
                  const std::array<LaneBox, lanes>& boxes, double threshold, SolutionBatch& out) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto r = [&](std::size_t i) { return factor.r[i][lane]; };
    double a[3][3] = {{r(0), r(1), r(2)}, {r(1), r(4), r(5)}, {r(2), r(5), r(7)}}, v[3][3];
    const double full[3][3] = {{r(0), r(1), r(2)}, {r(1), r(4), r(5)}, {r(2), r(5), r(7)}};
    const double rhs[3] = {r(3), r(6), r(8)};
    double m[3], c[3], x[3];
    for (int i = 0; i < 3; ++i)
      x[i] = m[i] = factor.mass[static_cast<std::size_t>(i)][lane] + centre[lane][i];
    for (int i = 0; i < 3; ++i)
      c[i] = as_float(rhs[i] - as_float(full[i][0] * m[0] + full[i][1] * m[1] + full[i][2] * m[2]));
    eigen(a, v);
    const double largest = std::max({a[0][0], a[1][1], a[2][2]});
    for (int k = 0; k < 3; ++k) {
      if (!(a[k][k] > largest * threshold * threshold)) continue;
      const double step = (v[0][k] * c[0] + v[1][k] * c[1] + v[2][k] * c[2]) / a[k][k];
      for (int i = 0; i < 3; ++i) x[i] += v[i][k] * step;
    }
    double quadratic = 0, linear = 0;
    for (int i = 0; i < 3; ++i) {
      const double local = boxes[lane].clamp(i, x[i] - centre[lane][i]);
      out.x[static_cast<std::size_t>(i)][lane] = local;
      x[i] = local + centre[lane][i];
    }
    for (int i = 0; i < 3; ++i) {
      linear = as_float(linear + as_float(2 * x[i] * rhs[i]));
      for (int j = 0; j < 3; ++j)
        quadratic = as_float(quadratic + as_float(x[i] * full[i][j] * x[j]));
    }
    out.energy[lane] = std::max(0.0, as_float(as_float(quadratic - linear) + r(9)));
  }
}

}  // namespace voxweld
