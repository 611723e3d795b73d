#include "stages/contouring/qef.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace voxweld {
namespace {

// Where planes leave a line of minima on the box's border, its ends and what lies between them
// differ by rounding alone. Then the one nearest the mass point is taken: an end can lie far from
// all crossings, outside the surface.
class Candidates {
 public:
  explicit Candidates(const BorderPoints& points) : points_(points) {}
  struct Place {
    std::size_t batch = 0, lane = 0;
  };
  // slack: the change of distance, the root of an energy, that rounding makes.
  Place best(double slack) const {
    double least = std::numeric_limits<double>::infinity();
    Place best{1, 0};  // an edge, which is in the box
    each([&](const Place& at) {
      if (!(energy(at) < least)) return;
      least = energy(at);
      best = at;
    });
    const double limit = std::sqrt(least) + slack, equal = limit * limit;
    each([&](const Place& at) {
      if (energy(at) <= equal && from_mass(at) < from_mass(best)) best = at;
    });
    return best;
  }
  double energy(const Place& at) const { return points_.energy[at.batch][at.lane]; }

 private:
  double from_mass(const Place& at) const { return points_.from_mass[at.batch][at.lane]; }
  template <class F>
  void each(const F& f) const {
    static constexpr std::array<std::size_t, 3> used = {6, 8, 4};
    for (std::size_t batch = 0; batch < 3; ++batch)
      for (std::size_t lane = 0; lane < used[batch]; ++lane)
        if (points_.in_box[batch][lane] != 0) f(Place{batch, lane});
  }
  const BorderPoints& points_;
};

// Of a stored factor after many merges, in units of what it is multiplied with.
constexpr double float_noise = 1e-5;

std::array<const QefKernels*, 3> widest_first() {
  return {qef_kernels_avx512(), qef_kernels_avx2(), &qef_kernels_base()};
}

const QefKernels*& chosen_kernels() {
  static const QefKernels* chosen = [] {
    for (const QefKernels* kernels : widest_first())
      if (kernels != nullptr) return kernels;
    return &qef_kernels_base();
  }();
  return chosen;
}

}  // namespace

const QefKernels& qef_kernels() {
  return *chosen_kernels();
}

bool choose_qef_kernels(std::string_view name) {
  for (const QefKernels* kernels : widest_first()) {
    if (kernels == nullptr || kernels->name != name) continue;
    chosen_kernels() = kernels;
    return true;
  }
  return false;
}

Qef store_lane(const FactorBatch& factor, std::size_t lane) {
  Qef qef;
  for (std::size_t i = 0; i < 10; ++i) qef.r[i] = static_cast<float>(factor.r[i][lane]);
  for (std::size_t a = 0; a < 3; ++a) qef.mass[a] = static_cast<float>(factor.mass[a][lane]);
  return qef;
}

void load_lane(const Qef& qef, std::size_t lane, FactorBatch& factor) {
  double planes = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    const double r = static_cast<double>(qef.r[i]);
    factor.r[i][lane] = r;
    if (i != 3 && i != 6 && i < 8) planes += r * r;
  }
  for (std::size_t a = 0; a < 3; ++a) factor.mass[a][lane] = static_cast<double>(qef.mass[a]);
  factor.planes[lane] = planes;
}

void constrain_lane(const FactorBatch& factor, std::size_t lane, const LaneBox& box,
                    double threshold, SolutionBatch& solution) {
  bool inside = true;
  for (int a = 0; a < 3; ++a)
    inside = inside && box.contains(a, solution.x[static_cast<std::size_t>(a)][lane]);
  if (inside) return;

  BoxedFactor boxed;
  for (std::size_t i = 0; i < 10; ++i) boxed.r[i] = factor.r[i][lane];
  for (std::size_t a = 0; a < 3; ++a) boxed.mass[a] = factor.mass[a][lane];
  boxed.box = box;
  // The cut must not depend on which face is tried: it is that of the largest column norm, within a
  // factor of sqrt(3) of the largest singular value.
  const std::array<double, 10>& r = boxed.r;
  const double largest =
      std::max({r[0] * r[0], r[1] * r[1] + r[4] * r[4], r[2] * r[2] + r[5] * r[5] + r[7] * r[7]});
  boxed.cut = largest * threshold * threshold;
  BorderPoints points;
  qef_kernels().border(boxed, points);
  double far = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double most = std::max(std::abs(box.lo[a]), std::abs(box.hi[a]));
    far += most * most;
  }
  const Candidates candidates(points);
  const auto best = candidates.best(float_noise * std::sqrt(factor.planes[lane] * far));
  for (std::size_t a = 0; a < 3; ++a) solution.x[a][lane] = points.x[best.batch][a][best.lane];
  solution.energy[lane] = candidates.energy(best);
}

}  // namespace voxweld
