// The crossing and normal of one lattice edge from samples (DESIGN: Hermite edges).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "stages/build/hermite_edge.h"
#include "stages/build/subcell.h"
#include "stages/contouring/inside_test.h"
#include "stages/contouring/parameters.h"
#include "storage/types/halo_block.h"

namespace voxweld {

// Doubles do not hold large 64-bit integers, but what such samples are above the integer nearest the
// isovalue. Of other types the base is 0.
template <class T>
inline constexpr bool has_base = std::is_integral_v<T> && sizeof(T) == 8;

template <class T>
double above_base(T value, T base) {
  if constexpr (has_base<T>) {
    using Bits = std::make_unsigned_t<T>;
    const auto v = static_cast<Bits>(value), b = static_cast<Bits>(base);
    return value >= base ? static_cast<double>(static_cast<Bits>(v - b))
                         : -static_cast<double>(static_cast<Bits>(b - v));
  } else {
    return static_cast<double>(value);
  }
}

template <class T>
T base_of(const Isovalue& isovalue) {
  if constexpr (has_base<T>) {
    // Towards 0: then what the isovalue has more than it is exact.
    const bool above = isovalue.value < 0;
    const Isovalue integer = isovalue.rest != 0 ? isovalue : Isovalue(std::trunc(isovalue.value));
    return make_inside_test<T>(integer, above ? Inside::above : Inside::below).threshold;
  } else {
    return 0;
  }
}

// A line of samples through one sample: p[0] is the sample, p[k * stride] its k-th neighbour.
template <class T>
struct Line {
  const T* p;
  std::int64_t stride;
  std::int64_t index;  // of the sample along the axis
  std::int64_t size;   // samples along the axis
  T base;
  double operator[](std::int64_t k) const { return above_base(p[k * stride], base); }
};

// The same with each sample times a power of two.
template <class T>
struct ScaledLine : Line<T> {
  double scale;
  double operator[](std::int64_t k) const { return Line<T>::operator[](k) * scale; }
};

// From the differences to the next sample and to the one behind it. Of differences, not of samples:
// where all are the same this is 0, and not what rounding leaves of their multiples.
inline double one_sided(double near, double far) {
  return 0.5 * (3 * near - far);
}

template <class Samples>
double central_difference(const Samples& f) {
  if (f.size < 2) return 0;
  if (f.index > 0 && f.index + 1 < f.size) return 0.5 * (f[1] - f[-1]);
  if (f.size == 2) return f.index == 0 ? f[1] - f[0] : f[0] - f[-1];
  // Three points, one-sided: second order up to the border.
  return f.index == 0 ? one_sided(f[1] - f[0], f[2] - f[1])
                      : one_sided(f[0] - f[-1], f[-1] - f[-2]);
}

// Essentially non-oscillatory (Harten, Engquist, Osher, Chakravarthy, 1987): of the three-point
// stencils that hold the sample, the one with the smallest second difference. Across a crease the
// smooth side wins, so the two faces' normals do not mix. none: what is returned where no second
// difference is finite.
template <class Samples>
double eno_difference(const Samples& f, double none) {
  if (f.size < 3) return central_difference(f);
  double best = std::numeric_limits<double>::infinity(), slope = none;
  const auto offer = [&](double second, double first) {
    if (std::abs(second) < best) {
      best = std::abs(second);
      slope = first;
    }
  };
  const double f0 = f[0];
  if (f.index > 0 && f.index + 1 < f.size) {
    const double lo = f[-1], hi = f[1];
    offer((hi - f0) - (f0 - lo), 0.5 * (hi - lo));
  }
  if (f.index > 1) {
    const double near = f0 - f[-1], far = f[-1] - f[-2];
    offer(near - far, one_sided(near, far));
  }
  if (f.index + 2 < f.size) {
    const double near = f[1] - f0, far = f[2] - f[1];
    offer(far - near, one_sided(near, far));
  }
  return slope;
}

template <class T>
class EdgeEstimator {
 public:
  EdgeEstimator(const HaloBlock& block, const ContourParameters& parameters)
      : block_(block),
        data_(reinterpret_cast<const T*>(block.data)),
        spacing_(parameters.spacing),
        base_(base_of<T>(parameters.surface.isovalue)),
        isovalue_(parameters.surface.isovalue.rest != 0
                      ? 0
                      : parameters.surface.isovalue.value - static_cast<double>(base_)),
        outward_(parameters.surface.inside == Inside::above ? -1.0 : 1.0),
        gradient_(parameters.surface.gradient),
        noise_(parameters.surface.noise) {}

  // The edge along `axis` from sample `s` to the next; low_inside: the sign of its low end.
  HermiteEdge edge(int axis, Index3 s, bool low_inside) const {
    if (s[axis] < 0 || s[axis] + 1 >= block_.size[axis]) return edge_of_middle(axis, low_inside);
    HermiteEdge result;
    const double out = low_inside ? 1.0 : -1.0;
    const T* low = sample(s);
    const double v0 = above_base(*low, base_), v1 = above_base(low[stride(axis)], base_);
    double t = (isovalue_ - v0) / (v1 - v0);
    if constexpr (may_overflow)
      if (!std::isfinite(v1 - v0)) t = (0.5 * isovalue_ - 0.5 * v0) / (0.5 * v1 - 0.5 * v0);
    if (!std::isfinite(v0) || !std::isfinite(v1) || !std::isfinite(t)) t = 0.5;
    t = std::clamp(t, lowest_crossing, highest_crossing);
    const Vec3 g =
        gradient_ == Gradient::subcell ? subcell_gradient(axis, s, t) : plain_gradient(axis, s, t);
    result.t = static_cast<float>(t);
    const double length = std::sqrt(dot(g, g));
    if (length > 0 && std::isfinite(length)) {
      for (int a = 0; a < 3; ++a)
        result.normal[static_cast<std::size_t>(a)] = static_cast<float>(outward_ * g[a] / length);
    } else {
      result.normal[static_cast<std::size_t>(axis)] = static_cast<float>(out);
    }
    return result;
  }

 protected:
  Index3 size() const { return block_.size; }
  std::int64_t stride(int axis) const {
    return axis == 0 ? 1 : axis == 1 ? block_.row : block_.slice;
  }
  const T* sample(Index3 s) const {
    const Index3 d = s - block_.samples.lo;
    return data_ + d.z * block_.slice + d.y * block_.row + d.x;
  }
  Vec3 gradient(const T* p, Index3 s) const {
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      const Line<T> f = line(a, p, s);
      g[a] =
          (gradient_ == Gradient::eno ? eno_difference(f, no_difference) : central_difference(f)) /
          spacing_[a];
    }
    return g;
  }

 private:
  // Differences of doubles may overflow, and their squares sooner: where one has, or has come close
  // to vanishing, all is done again with the samples scaled to at most 1. Only directions matter.
  static constexpr bool may_overflow = std::is_same_v<T, double>;
  static constexpr double least_length = 1e-140;
  static constexpr double no_difference =
      may_overflow ? std::numeric_limits<double>::infinity() : 0;

  Line<T> line(int axis, const T* p, Index3 s) const {
    return {p, stride(axis), s[axis], block_.size[axis], base_};
  }
  ScaledLine<T> line(int axis, const T* p, Index3 s, double scale) const {
    return {line(axis, p, s), scale};
  }

  Vec3 plain_gradient(int axis, Index3 s, double t) const {
    const Vec3 g = gradient_at(axis, s, t);
    if constexpr (may_overflow) {
      const double length = std::sqrt(dot(g, g));
      if (!(length > least_length && std::isfinite(length)))
        return gradient_at(axis, s, t, scale_around(axis, s));
    }
    return g;
  }

  // Moves t from where a straight line crosses to where the surface does.
  Vec3 subcell_gradient(int axis, Index3 s, double& t) const {
    if constexpr (may_overflow) {
      const double scale = scale_around(axis, s);
      return subcell_gradient(axis, s, t, KinkGate{noise_ * scale}, isovalue_ * scale, scale);
    } else {
      return subcell_gradient(axis, s, t, KinkGate{noise_}, isovalue_);
    }
  }
  template <class... Scale>
  Vec3 subcell_gradient(int axis, Index3 s, double& t, const KinkGate& gate, double level,
                        Scale... scale) const {
    Index3 next = s;
    ++next[axis];
    const T *low = sample(s), *high = low + stride(axis);
    const auto line_low = [&](int a) { return line(a, low, s, scale...); };
    const auto line_high = [&](int a) { return line(a, high, next, scale...); };
    Vec3 g;
    for (int a = 0; a < 3; ++a)
      g[a] = (central_difference(line_low(a)) * (1 - t) + central_difference(line_high(a)) * t) /
             spacing_[a];
    const Vec3 step = spacing_ * std::sqrt(dot(g, g));
    const KinkedCrossing crossing =
        kinked_crossing(line_low(axis), line_high(axis), level, step[axis], gate);
    bool kinked = crossing.kinked;
    for (int a = 0; a < 3 && !kinked; ++a)
      kinked = has_kink_beside(line_low(a), step[a], gate) ||
               has_kink_beside(line_high(a), step[a], gate);
    if (!kinked) return g;
    // Of the sheet that the crossing is on, which the sample on its side of the kink is on too.
    if (crossing.kinked) t = std::clamp(crossing.t, lowest_crossing, highest_crossing);
    const bool at_low = crossing.kinked ? crossing.low : t <= 0.5;
    for (int a = 0; a < 3; ++a) {
      const auto f = at_low ? line_low(a) : line_high(a);
      const double slope = crossing.kinked && a == axis ? crossing.slope
                           : has_kink_beside(f, step[a], gate)
                               ? smooth_side_difference(f, step[a], gate)
                               : central_difference(f);
      g[a] = slope / spacing_[a];
    }
    return g;
  }

  // Of the crossing at t of the edge along `axis` from sample s. scale: that of the samples, if any.
  template <class... Scale>
  Vec3 gradient_at(int axis, Index3 s, double t, Scale... scale) const {
    const T* low = sample(s);
    Index3 high = s;
    ++high[axis];
    if (gradient_ == Gradient::eno)
      return t <= 0.5 ? gradient(low, s, scale...) : gradient(low + stride(axis), high, scale...);
    return gradient(low, s, scale...) * (1 - t) + gradient(low + stride(axis), high, scale...) * t;
  }
  Vec3 gradient(const T* p, Index3 s, double scale) const {
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      const ScaledLine<T> f = line(a, p, s, scale);
      g[a] =
          (gradient_ == Gradient::eno ? eno_difference(f, 0) : central_difference(f)) / spacing_[a];
    }
    return g;
  }

  // The power of two that makes the largest of the finite samples which the gradients at both ends
  // read at most 1.
  double scale_around(int axis, Index3 s) const {
    double largest = 0;
    for (Index3 at = s; at[axis] <= s[axis] + 1; ++at[axis])
      for (int a = 0; a < 3; ++a)
        for (std::int64_t k = -gradient_halo; k <= gradient_halo; ++k) {
          if (at[a] + k < 0 || at[a] + k >= block_.size[a]) continue;
          const double magnitude = std::abs(static_cast<double>(sample(at)[k * stride(a)]));
          if (std::isfinite(magnitude)) largest = std::max(largest, magnitude);
        }
    int exponent = 0;
    std::frexp(largest, &exponent);
    return std::ldexp(1.0, std::min(-exponent, 1000));
  }

  const HaloBlock& block_;
  const T* data_;
  Vec3 spacing_;
  T base_;
  double isovalue_, outward_;
  Gradient gradient_;
  double noise_;
};

}  // namespace voxweld
