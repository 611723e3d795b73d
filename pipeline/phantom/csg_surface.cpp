#include "pipeline/phantom/csg_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace voxweld {
namespace {

using Op = CsgPrimitive::Op;

constexpr double on_surface = 1e-7;   // model units
constexpr double unreachable = 4096;  // larger than any model

Vec3 unit(int axis, double sign) {
  Vec3 v;
  v[axis] = sign;
  return v;
}

// Solves the symmetric n x n system m x = b, n <= 3, by Gaussian elimination with pivoting; false
// when it is close to singular (sheets that are parallel here).
bool solve(std::array<std::array<double, 3>, 3> m, std::array<double, 3> b, int count,
           std::array<double, 3>& x) {
  const auto n = static_cast<std::size_t>(count);
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(m[i][k]) > std::abs(m[pivot][k])) pivot = i;
    if (std::abs(m[pivot][k]) < 1e-9) return false;
    std::swap(m[k], m[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = m[i][k] / m[k][k];
      for (std::size_t j = k; j < n; ++j) m[i][j] -= f * m[k][j];
      b[i] -= f * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    x[k] = b[k];
    for (std::size_t j = k + 1; j < n; ++j) x[k] -= m[k][j] * x[j];
    x[k] /= m[k][k];
  }
  return true;
}

}  // namespace

CsgSurface::CsgSurface(CsgModel model) : model_(std::move(model)), sheets_(sheets_of(model_)) {}

CsgSurface::Winner CsgSurface::winner(Vec3 q) const {
  Winner result{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < model_.primitives.size(); ++i) {
    const CsgPrimitive& primitive = model_.primitives[i];
    const double d = signed_distance(primitive, q);
    if (primitive.op == Op::unite ? d < result.value : -d > result.value)
      result = {primitive.op == Op::unite ? d : -d, i};
  }
  return result;
}

double CsgSurface::value(Vec3 q) const {
  return winner(q).value;
}

std::vector<CsgSurface::Sheet> CsgSurface::sheets_of(const CsgModel& model) {
  std::vector<Sheet> sheets;
  for (std::size_t i = 0; i < model.primitives.size(); ++i) {
    const CsgPrimitive& p = model.primitives[i];
    const auto caps = [&](int axis) {
      for (const double sign : {-1.0, 1.0})
        sheets.push_back({-1, p.centre + unit(axis, sign * p.half[axis]), unit(axis, sign), 0, i});
    };
    switch (p.shape) {
      case CsgShape::box:
        for (int axis = 0; axis < 3; ++axis) caps(axis);
        break;
      case CsgShape::cylinder_x:
        caps(0);
        sheets.push_back({0, p.centre, {}, p.half.y, i});
        break;
      case CsgShape::cylinder_z:
        caps(2);
        sheets.push_back({2, p.centre, {}, p.half.x, i});
        break;
      case CsgShape::gable: {
        caps(0);
        sheets.push_back({-1, p.centre + unit(2, -p.half.z), unit(2, -1), 0, i});
        const double norm = std::sqrt(4 * p.half.z * p.half.z + p.half.y * p.half.y);
        for (const double sign : {-1.0, 1.0})
          sheets.push_back({-1, p.centre + unit(2, p.half.z),
                            Vec3{0, sign * 2 * p.half.z / norm, p.half.y / norm}, 0, i});
        break;
      }
    }
  }
  return sheets;
}

CsgSurface::Tangent CsgSurface::tangent(const Sheet& sheet, Vec3 q) {
  Vec3 r = q - sheet.point;
  if (sheet.axis < 0) return {dot(r, sheet.normal), sheet.normal};
  r[sheet.axis] = 0;
  const double radial = length(r);
  if (radial == 0)
    return {-sheet.radius, unit((sheet.axis + 1) % 3, 1)};  // any direction is as good
  return {radial - sheet.radius, r * (1 / radial)};
}

// Each step walks to the point of all tangent planes nearest to `from`:
// delta = g - N^T lambda, g = from - x, (N N^T) lambda = N g + f.
bool CsgSurface::meet(const Sheet* const* sheets, int count, Vec3 from, Vec3& found) {
  const auto n = static_cast<std::size_t>(count);
  Vec3 x = from;
  for (int step = 0; step < 60; ++step) {
    std::array<Tangent, 3> t;
    for (std::size_t i = 0; i < n; ++i) t[i] = tangent(*sheets[i], x);
    const Vec3 g = from - x;
    std::array<std::array<double, 3>, 3> gram{};
    std::array<double, 3> rhs{}, lambda{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) gram[i][j] = dot(t[i].normal, t[j].normal);
      rhs[i] = dot(t[i].normal, g) + t[i].value;
    }
    if (!solve(gram, rhs, count, lambda)) return false;
    Vec3 delta = g;
    for (std::size_t i = 0; i < n; ++i) delta = delta - t[i].normal * lambda[i];
    x = x + delta;
    if (length(delta) < 1e-11 * unreachable) {
      found = x;
      return true;
    }
  }
  return false;
}

void CsgSurface::consider(const Sheet* const* sheets, int count, Best& best) const {
  Vec3 x;
  if (!meet(sheets, count, best.from, x)) return;
  const double distance = length(x - best.from);
  if (distance < best.distance && std::abs(value(x)) < on_surface) best.distance = distance;
}

// The sheets that can hold a boundary point within `radius` of q: those that near themselves, of
// primitives whose own boundary comes that near. Nearest first.
std::vector<CsgSurface::Near> CsgSurface::near(Vec3 q, double radius) const {
  std::vector<double> primitives;
  for (const CsgPrimitive& p : model_.primitives)
    primitives.push_back(std::abs(signed_distance(p, q)));
  std::vector<Near> result;
  for (const Sheet& sheet : sheets_) {
    if (primitives[sheet.primitive] > radius) continue;
    const double d = std::abs(tangent(sheet, q).value);
    if (d <= radius) result.push_back({&sheet, d});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Near& a, const Near& b) { return a.distance < b.distance; });
  return result;
}

void CsgSurface::search(const std::vector<Near>& list, Best& best) const {
  const auto done = [&] { return best.distance <= best.lower_bound + on_surface; };
  for (const Near& a : list) {
    const std::array one = {a.sheet};
    if (a.distance < best.distance) consider(one.data(), 1, best);
    if (done()) return;
  }
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = 0; j < i && list[i].distance < best.distance; ++j) {
      const std::array two = {list[j].sheet, list[i].sheet};
      consider(two.data(), 2, best);
    }
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < j && list[i].distance < best.distance; ++k) {
        const std::array three = {list[k].sheet, list[j].sheet, list[i].sheet};
        consider(three.data(), 3, best);
      }
}

double CsgSurface::distance(Vec3 q) const {
  const Winner at = winner(q);
  const double lower_bound = std::abs(at.value);
  Best best{q, std::numeric_limits<double>::infinity(), lower_bound};
  // Nearly always the foot on the winning primitive lies on the boundary.
  for (const Sheet& sheet : sheets_) {
    if (sheet.primitive != at.primitive ||
        std::abs(std::abs(tangent(sheet, q).value) - lower_bound) > on_surface)
      continue;
    const std::array one = {&sheet};
    consider(one.data(), 1, best);
    if (best.distance <= lower_bound + on_surface) return best.distance;
  }
  // Any boundary point within the radius has all its sheets within it, so a find inside is final.
  for (double radius = 2 * lower_bound + 1; radius < unreachable; radius *= 2) {
    search(near(q, radius), best);
    if (best.distance <= radius) break;
  }
  return best.distance;
}

}  // namespace voxweld
