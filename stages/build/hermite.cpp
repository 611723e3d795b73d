#include "stages/build/hermite.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/geometry/mesh_solid.h"
#include "stages/geometry/solid.h"

namespace voxweld {
namespace {

// A line of samples through one sample: p[0] is the sample, p[k * stride] its k-th neighbour.
template <class T>
struct Line {
  const T* p;
  std::int64_t stride;
  std::int64_t index;  // of the sample along the axis
  std::int64_t size;   // samples along the axis
  double operator[](std::int64_t k) const { return static_cast<double>(p[k * stride]); }
};

constexpr double lowest_crossing = 1.0 / 256, highest_crossing = 255.0 / 256;

// Of an edge with one end in the ring, or of which no more is known than its ends.
HermiteEdge edge_of_middle(int axis, bool low_inside) {
  HermiteEdge edge;
  edge.t = 0.5f;
  edge.normal[static_cast<std::size_t>(axis)] = low_inside ? 1.0f : -1.0f;
  return edge;
}

template <class T>
double central_difference(const Line<T>& f) {
  if (f.size < 2) return 0;
  if (f.index > 0 && f.index + 1 < f.size) return 0.5 * (f[1] - f[-1]);
  if (f.size == 2) return f.index == 0 ? f[1] - f[0] : f[0] - f[-1];
  // Three points, one-sided: second order up to the border.
  return f.index == 0 ? 0.5 * (4 * f[1] - 3 * f[0] - f[2]) : 0.5 * (3 * f[0] - 4 * f[-1] + f[-2]);
}

// Essentially non-oscillatory (Harten, Engquist, Osher, Chakravarthy, 1987): of the three-point
// stencils that hold the sample, the one with the smallest second difference. Across a crease the
// smooth side wins, so the two faces' normals do not mix.
template <class T>
double eno_difference(const Line<T>& f) {
  if (f.size < 3) return central_difference(f);
  double best = std::numeric_limits<double>::infinity(), slope = 0;
  const auto offer = [&](double second, double first) {
    if (std::abs(second) < best) {
      best = std::abs(second);
      slope = first;
    }
  };
  const double f0 = f[0];
  if (f.index > 0 && f.index + 1 < f.size) {
    const double lo = f[-1], hi = f[1];
    offer(hi - 2 * f0 + lo, 0.5 * (hi - lo));
  }
  if (f.index > 1) {
    const double near = f[-1], far = f[-2];
    offer(f0 - 2 * near + far, 0.5 * (3 * f0 - 4 * near + far));
  }
  if (f.index + 2 < f.size) {
    const double near = f[1], far = f[2];
    offer(far - 2 * near + f0, 0.5 * (4 * near - 3 * f0 - far));
  }
  return slope;
}

template <class T>
class Estimator {
 public:
  Estimator(const HaloBlock& block, const ContourParameters& parameters)
      : block_(block),
        data_(reinterpret_cast<const T*>(block.data)),
        spacing_(parameters.spacing),
        isovalue_(parameters.surface.isovalue),
        outward_(parameters.surface.inside == Inside::above ? -1.0 : 1.0),
        eno_(parameters.surface.gradient == Gradient::eno) {}

  // The edge along `axis` from sample `s` to the next; low_inside: the sign of its low end.
  HermiteEdge edge(int axis, Index3 s, bool low_inside) const {
    if (s[axis] < 0 || s[axis] + 1 >= block_.size[axis]) return edge_of_middle(axis, low_inside);
    HermiteEdge result;
    const double out = low_inside ? 1.0 : -1.0;
    const T* low = sample(s);
    const double v0 = static_cast<double>(*low), v1 = static_cast<double>(low[stride(axis)]);
    double t = (isovalue_ - v0) / (v1 - v0);
    if (!std::isfinite(v0) || !std::isfinite(v1) || !std::isfinite(t)) t = 0.5;
    // Only a filtered label can fall towards its inside: where that is thinner than the filter.
    const double rise = outward_ * (v1 - v0);
    if (low_inside ? rise < 0 : rise > 0) return edge_of_middle(axis, low_inside);
    t = std::clamp(t, lowest_crossing, highest_crossing);
    result.t = static_cast<float>(t);
    Vec3 g;
    Index3 high = s;
    ++high[axis];
    if (eno_)
      g = t <= 0.5 ? gradient(low, s) : gradient(low + stride(axis), high);
    else
      g = gradient(low, s) * (1 - t) + gradient(low + stride(axis), high) * t;
    const double length = std::sqrt(dot(g, g));
    if (length > 0 && std::isfinite(length)) {
      for (int a = 0; a < 3; ++a)
        result.normal[static_cast<std::size_t>(a)] = static_cast<float>(outward_ * g[a] / length);
    } else {
      result.normal[static_cast<std::size_t>(axis)] = static_cast<float>(out);
    }
    return result;
  }

 private:
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
      const Line<T> line{p, stride(a), s[a], block_.size[a]};
      g[a] = (eno_ ? eno_difference(line) : central_difference(line)) / spacing_[a];
    }
    return g;
  }

  const HaloBlock& block_;
  const T* data_;
  Vec3 spacing_;
  double isovalue_, outward_;
  bool eno_;
};

// Word w of a sign row with x = 0 in bit 0.
std::uint64_t from_zero(const std::uint64_t* row, std::size_t w) {
  return row[w] >> 1 | row[w + 1] << 63;
}

}  // namespace

void HermiteEdges::find_rows(const SignGrid& signs, int side) {
  points_ = static_cast<std::size_t>(side) + 1;
  row_words_ = (points_ + 63) / 64;
  bits_.assign(3 * points_ * points_ * row_words_, 0);
  first_.resize(bits_.size());
  for (int z = 0; z <= side; ++z)
    for (int y = 0; y <= side; ++y)
      for (std::size_t w = 0; w < row_words_; ++w) {
        const int last = side - static_cast<int>(w) * 64;  // x = side in this word, or past it
        const std::uint64_t points =
            last >= 63 ? ~std::uint64_t{0} : (std::uint64_t{2} << last) - 1;
        const std::uint64_t starts =
            last >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << last) - 1;
        const std::uint64_t* row = signs.row(y, z);
        const std::uint64_t here = from_zero(row, w);
        const std::uint64_t next = row[w] >> 2 | row[w + 1] << 62;
        const int x0 = static_cast<int>(w) * 64;
        bits_[word_of(0, x0, y, z)] = (here ^ next) & starts;
        if (y < side)
          bits_[word_of(1, x0, y, z)] = (here ^ from_zero(signs.row(y + 1, z), w)) & points;
        if (z < side)
          bits_[word_of(2, x0, y, z)] = (here ^ from_zero(signs.row(y, z + 1), w)) & points;
      }
  std::uint32_t count = 0;
  for (std::size_t w = 0; w < bits_.size(); ++w) {
    first_[w] = count;
    count += static_cast<std::uint32_t>(std::popcount(bits_[w]));
  }
  edges_.resize(count);
}

// edge_of(axis, x, y, z) of every crossing edge, in the order they are kept.
template <class F>
void HermiteEdges::fill_edges(int side, F&& edge_of) {
  std::size_t next = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int z = 0; z <= side; ++z)
      for (int y = 0; y <= side; ++y)
        for (std::size_t w = 0; w < row_words_; ++w)
          for (std::uint64_t rest = bits_[word_of(axis, static_cast<int>(w) * 64, y, z)]; rest != 0;
               rest &= rest - 1)
            edges_[next++] = edge_of(axis, static_cast<int>(w) * 64 + std::countr_zero(rest), y, z);
}

void HermiteEdges::compute(const HaloBlock& block, Index3 brick, int side, const SignGrid& signs,
                           const ContourParameters& parameters) {
  find_rows(signs, side);
  dispatch_sample_type(block.type, [&](auto tag) {
    const Estimator<typename decltype(tag)::type> estimator(block, parameters);
    fill_edges(side, [&](int axis, int x, int y, int z) {
      return estimator.edge(axis, brick + Index3{x, y, z} - splat(1), signs.inside(x, y, z));
    });
  });
}

namespace {

// The solid's own crossing of the edge from sample s on, and its normal there.
MeshSolid::Crossing crossing_of(const Solid& solid, const VolumeFrame& frame, int axis, Index3 s,
                                bool low_in_solid) {
  if (solid.shape == SolidShape::mesh) return solid.mesh->crossing(axis, s, low_in_solid);
  const Vec3 low = frame.place_of_sample(s);
  const double length = frame.spacing[axis];
  const double t = solid_crossing(solid, low, axis, length);
  Vec3 place = low;
  place[axis] += t * length;
  return {t, solid_normal(solid, place)};
}

// Outward of what the edit leaves.
HermiteEdge edge_of_solid(const Edit& edit, const VolumeFrame& frame, int axis, Index3 s,
                          bool low_in_solid) {
  const auto crossing = crossing_of(edit.solid, frame, axis, s, low_in_solid);
  const Vec3 normal = crossing.normal * (edit.op == EditOp::subtract ? -1.0 : 1.0);
  HermiteEdge edge;
  edge.t = static_cast<float>(std::clamp(crossing.t, lowest_crossing, highest_crossing));
  for (int a = 0; a < 3; ++a)
    edge.normal[static_cast<std::size_t>(a)] = static_cast<float>(normal[a]);
  return edge;
}

// Both surfaces cross the edge, both in the same direction: of a union the one further out is the
// surface, of an intersection the one further in.
const HermiteEdge& surface_of(EditOp op, bool low_inside, const HermiteEdge& before,
                              const HermiteEdge& solid) {
  const bool takes_higher = (op == EditOp::add) == low_inside;
  const bool solid_wins = takes_higher ? solid.t > before.t : solid.t < before.t;
  return solid_wins ? solid : before;
}

}  // namespace

void HermiteEdges::compute(const Edit& edit, const VolumeFrame& frame, Index3 brick, int side,
                           const SignGrid& signs, const SignGrid& solid,
                           const HermiteEdges& before) {
  find_rows(signs, side);
  fill_edges(side, [&](int axis, int x, int y, int z) {
    const Index3 s = brick + Index3{x, y, z} - splat(1);
    const bool low_inside = signs.inside(x, y, z);
    if (s[axis] < 0 || s[axis] + 1 >= frame.size[axis]) return edge_of_middle(axis, low_inside);
    const int dx = axis == 0, dy = axis == 1, dz = axis == 2;
    const bool low_in_solid = solid.inside(x, y, z);
    const bool of_solid = low_in_solid != solid.inside(x + dx, y + dy, z + dz);
    if (!of_solid) return before.at(axis, x, y, z);
    const HermiteEdge own = edge_of_solid(edit, frame, axis, s, low_in_solid);
    if (!before.has(axis, x, y, z)) return own;
    return surface_of(edit.op, low_inside, before.at(axis, x, y, z), own);
  });
}

}  // namespace voxweld
