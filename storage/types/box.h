// Integer and real 3-vectors and half-open boxes. Axis order is always x, y, z with x fastest in
// memory; counts are 64-bit so that products of extents never overflow.
#pragma once

#include <algorithm>
#include <cstdint>

namespace voxweld {

struct Index3 {
  std::int64_t x = 0, y = 0, z = 0;

  constexpr std::int64_t& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr std::int64_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const Index3&, const Index3&) = default;
  friend constexpr Index3 operator+(Index3 a, Index3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Index3 operator-(Index3 a, Index3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Index3 operator*(Index3 a, std::int64_t s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

constexpr Index3 min(Index3 a, Index3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Index3 max(Index3 a, Index3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
constexpr Index3 splat(std::int64_t v) {
  return {v, v, v};
}

constexpr Index3 divide(Index3 a, Index3 b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};

constexpr Vec3 as_vec3(Index3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
constexpr Vec3 min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Vec3 max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The lattice points (or samples, or cells) lo <= p < hi on each axis.
struct Box3 {
  Index3 lo, hi;

  constexpr Index3 size() const { return hi - lo; }
  constexpr bool empty() const { return hi.x <= lo.x || hi.y <= lo.y || hi.z <= lo.z; }
  constexpr std::int64_t count() const {
    return empty() ? 0 : (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z);
  }
  constexpr bool contains(Index3 p) const {
    return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x < hi.x && p.y < hi.y && p.z < hi.z;
  }
  constexpr bool contains(const Box3& b) const {
    return b.empty() || (b.lo.x >= lo.x && b.lo.y >= lo.y && b.lo.z >= lo.z && b.hi.x <= hi.x &&
                         b.hi.y <= hi.y && b.hi.z <= hi.z);
  }
  friend constexpr bool operator==(const Box3&, const Box3&) = default;
};

// f(p) of each, x fastest; of a size: of the box from 0 on.
template <class F>
constexpr void each_index(const Box3& box, F&& f) {
  for (Index3 p = box.lo; p.z < box.hi.z; ++p.z)
    for (p.y = box.lo.y; p.y < box.hi.y; ++p.y)
      for (p.x = box.lo.x; p.x < box.hi.x; ++p.x) f(p);
}
template <class F>
constexpr void each_index(Index3 size, F&& f) {
  each_index(Box3{{}, size}, f);
}
// Of a grid of pieces of that size from 0 on, those that the box has a part in. Precondition: not
// empty, nothing below 0.
constexpr Box3 pieces_of(const Box3& box, Index3 piece) {
  return {divide(box.lo, piece), divide(box.hi - splat(1), piece) + splat(1)};
}

constexpr Box3 intersect(const Box3& a, const Box3& b) {
  return {max(a.lo, b.lo), min(a.hi, b.hi)};
}

}  // namespace voxweld
