#include "stages/refine/nearest_triangle.h"

#include <bit>
#include <limits>

namespace voxweld {
namespace {

Vec3 offset(const LatticePoint& from, const LatticePoint& to) {
  return {static_cast<double>(to[0] - from[0]), static_cast<double>(to[1] - from[1]),
          static_cast<double>(to[2] - from[2])};
}

using FourBits = std::int32_t __attribute__((vector_size(16)));

// A bit for each that is set.
std::uint32_t bits_of(FourBits comparison) {
#ifdef __SSE2__
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps(
      reinterpret_cast<__attribute__((vector_size(16))) float>(comparison)));
#else
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= comparison[i] != 0 ? std::uint32_t{1} << i : 0;
  return bits;
#endif
}

// A distance that was rounded may be less than the exact one to the triangle's box, and that to the box
// more, which has fewer bits: by this part at most.
constexpr double rounding = 1e-6;

}  // namespace

MeasuredTriangle::MeasuredTriangle(const LatticeTriangle& t)
    : first_(t[0]),
      ab_(offset(t[0], t[1])),
      ac_(offset(t[0], t[2])),
      normal_(cross(ab_, ac_)),
      abab_(dot(ab_, ab_)),
      abac_(dot(ab_, ac_)),
      acac_(dot(ac_, ac_)),
      nn_(dot(normal_, normal_)) {}

// Ericson, "Real-Time Collision Detection", 2005, section 5.1.5, with the point at the origin.
double MeasuredTriangle::squared_distance(const LatticePoint& point) const {
  const Vec3 a = offset(point, first_);
  const auto squared = [](Vec3 v) { return dot(v, v); };
  const double d1 = -dot(ab_, a), d2 = -dot(ac_, a);
  if (d1 <= 0 && d2 <= 0) return squared(a);
  const double d3 = d1 - abab_, d4 = d2 - abac_;
  if (d3 >= 0 && d4 <= d3) return squared(a + ab_);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(a + ab_ * (d1 / (d1 - d3)));
  const double d5 = d1 - abac_, d6 = d2 - acac_;
  if (d6 >= 0 && d5 <= d6) return squared(a + ac_);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(a + ac_ * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return squared(a + ab_ + (ac_ - ab_) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double height = dot(normal_, a);
  return height * height / nn_;
}

double squared_distance(const LatticePoint& point, const LatticeTriangle& triangle) {
  return MeasuredTriangle(triangle).squared_distance(point);
}

void NearestTriangles::add(const LatticeTriangle& shape, const MaterialPair& sides) {
  const std::size_t lane = triangles_.size() % lanes, group = triangles_.size() / lanes;
  if (group == boxes_.size()) boxes_.emplace_back();
  const LatticeBox box = LatticeBox::around(shape);
  for (std::size_t a = 0; a < 3; ++a) {
    boxes_[group].lo[a][lane] = box.lo[a];
    boxes_[group].hi[a][lane] = box.hi[a];
  }
  triangles_.push_back({shape, sides, 0});
}

double NearestTriangles::squared_distance(std::size_t triangle, const LatticePoint& point) {
  Triangle& one = triangles_[triangle];
  if (one.measured == 0) {
    measured_.emplace_back(one.shape);
    one.measured = static_cast<std::uint32_t>(measured_.size());
  }
  return measured_[one.measured - 1].squared_distance(point);
}

NearestTriangles::Floats NearestTriangles::Boxes::squared_distances(
    const LatticePoint& point) const {
  Floats sum{};
  for (std::size_t a = 0; a < 3; ++a) {
    const Ints below = lo[a] - point[a], above = point[a] - hi[a];
    const Ints out = below > above ? below : above;
    const Floats distance = __builtin_convertvector(out > 0 ? out : Ints{}, Floats);
    sum += distance * distance;
  }
  return sum;
}

Nearest NearestTriangles::to(const LatticePoint& point, const MaterialPair& sides,
                             std::size_t guess, double enough) {
  Nearest best{std::numeric_limits<double>::infinity(), 0};
  float most = std::numeric_limits<float>::infinity();
  const auto look = [&](std::size_t i) {
    const double d = squared_distance(i, point);
    if (d > best.squared || (d == best.squared && i > best.triangle)) return;
    best = {d, i};
    most = static_cast<float>(d * (1 + rounding));
  };
  if (guess < triangles_.size() && triangles_[guess].sides == sides) look(guess);
  if (best.squared <= enough) return best;
  for (std::size_t first = 0; first < triangles_.size(); first += lanes) {
    const Floats far = boxes_[first / lanes].squared_distances(point);
    for (std::uint32_t near = bits_of(far <= most); near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      const std::size_t i = first + lane;
      if (i >= triangles_.size()) break;
      if (far[lane] <= most && i != guess && triangles_[i].sides == sides) look(i);
      if (best.squared <= enough) return best;
    }
  }
  return best;
}

}  // namespace voxweld
