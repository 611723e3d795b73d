#include "stages/solids/mesh_solid.h"

#include <cmath>
#include <tuple>

namespace voxweld {
namespace {

// With places within 2^20 cells, points are of at most 2^40 steps, their differences 2^41, areas
// 2^83, and an area times a difference, three times, 2^126: nothing overflows.
using Wide = __int128;
constexpr int cell_bits = mesh_cell_bits;
constexpr std::int64_t cell = mesh_cell;

struct Plane {  // of a triangle: normal.(p - point) is 0 on it
  std::array<Wide, 3> normal;
  Index3 point;

  Wide value(Index3 p) const {
    const Index3 d = p - point;
    return normal[0] * d.x + normal[1] * d.y + normal[2] * d.z;
  }
  // On which side p is once it is moved by (e, e^2, e^3).
  bool above(Index3 p) const { return above(value(p)); }
  bool above(Wide value) const {
    if (value != 0) return value > 0;
    if (normal[0] != 0) return normal[0] > 0;
    return normal[1] != 0 ? normal[1] > 0 : normal[2] > 0;
  }
};

Plane plane_of(const std::array<Index3, 3>& c) {
  const Index3 a = c[1] - c[0], b = c[2] - c[0];
  const auto area = [](std::int64_t p, std::int64_t q, std::int64_t r, std::int64_t s) {
    return static_cast<Wide>(p) * s - static_cast<Wide>(q) * r;
  };
  return {{area(a.y, a.z, b.y, b.z), area(a.z, a.x, b.z, b.x), area(a.x, a.y, b.x, b.y)}, c[0]};
}

// On which side of the line from a to b the moved p is, seen along the axis across `u` and `v`, u
// the lower of them; 0 where the line is seen as a point.
int side(Index3 a, Index3 b, Index3 p, int u, int v) {
  const std::int64_t du = b[u] - a[u], dv = b[v] - a[v];
  const Wide area = static_cast<Wide>(du) * (p[v] - a[v]) - static_cast<Wide>(dv) * (p[u] - a[u]);
  if (area != 0) return area > 0 ? 1 : -1;
  // The step along u is the larger one.
  if (dv != 0) return dv < 0 ? 1 : -1;
  return du > 0 ? 1 : du < 0 ? -1 : 0;
}

// Whether the row through the moved p along `axis` meets the triangle. One seen edge-on is never
// met: its three sides add up to nothing, so they are not all alike.
bool meets_row(const std::array<Index3, 3>& c, Index3 p, int axis) {
  const auto [u, v] = axes_across[static_cast<std::size_t>(axis)];
  const int first = side(c[0], c[1], p, u, v);
  return first != 0 && side(c[1], c[2], p, u, v) == first && side(c[2], c[0], p, u, v) == first;
}

struct Range {
  std::int64_t lo, hi;
};

Range range(const std::array<Index3, 3>& c, int axis) {
  const auto [lo, hi] = std::minmax({c[0][axis], c[1][axis], c[2][axis]});
  return {lo, hi};
}

// The samples a range of steps may hold, half-open.
Range samples_in(Range steps) {
  return {(steps.lo + cell - 1) >> cell_bits, (steps.hi >> cell_bits) + 1};
}

// The first sample of the row through p along x that is beyond the plane.
std::int64_t first_beyond(const Plane& plane, Index3 p) {
  Wide value = plane.value(p), step = plane.normal[0] << cell_bits;
  if (step < 0) {
    value = -value;
    step = -step;
  }
  // A sample on the plane is beyond it: of the steps it is moved by, the one along x is largest.
  const Wide need = -value;
  const Wide whole = need / step;
  return static_cast<std::int64_t>(whole * step < need ? whole + 1 : whole);
}

MeshRowIndex::Rows reached_rows(const std::array<Index3, 3>& c, std::size_t along,
                                const Box3& within) {
  MeshRowIndex::Rows reached;
  for (std::size_t i = 0; i < 2; ++i) {
    const int axis = axes_across[along][i];
    const Range samples = samples_in(range(c, axis));
    reached.lo[i] = std::max(samples.lo, within.lo[axis]);
    reached.hi[i] = std::min(samples.hi, within.hi[axis]);
  }
  return reached;
}

}  // namespace

bool triangle_reaches(const std::array<Index3, 3>& corners, const Box3& samples) {
  const Index3 lo = samples.lo * cell, hi = (samples.hi - splat(1)) * cell;
  int with_samples = 0;  // axes on which it reaches over a sample of the box
  for (int axis = 0; axis < 3; ++axis) {
    const Range own = range(corners, axis);
    if (own.lo > hi[axis] || own.hi < lo[axis]) return false;
    const Range held = samples_in({std::max(own.lo, lo[axis]), std::min(own.hi, hi[axis])});
    with_samples += held.lo < held.hi ? 1 : 0;
  }
  if (with_samples < 2) return false;
  const Plane plane = plane_of(corners);
  bool below = true, above = true;
  for (int corner = 0; corner < 8; ++corner) {
    const Wide value =
        plane.value({(corner & 1) != 0 ? hi.x : lo.x, (corner & 2) != 0 ? hi.y : lo.y,
                     (corner & 4) != 0 ? hi.z : lo.z});
    below = below && value < 0;
    above = above && value > 0;
  }
  return !below && !above;
}

MeshSolid::MeshSolid(const TriangleMesh& mesh, const VolumeFrame& frame, Hash128 source)
    : triangles_(mesh.triangles), spacing_(frame.spacing), source_(source) {
  points_.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) points_.push_back(snapped_corner(v, spacing_));
  find_bounds();
  index_rows({{}, frame.size});
  blocks_ = BlockSet(frame.size);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const Corners c = corners(i);
    Box3 samples;  // those at or below what it holds
    for (int axis = 0; axis < 3; ++axis) {
      const Range own = range(c, axis);
      samples.lo[axis] = own.lo >> cell_bits;
      samples.hi[axis] = (own.hi >> cell_bits) + 1;
    }
    blocks_.add(samples);
  }
}

MeshSolid::MeshSolid(std::vector<Index3> corners, const Box3& samples, Vec3 spacing, Hash128 source)
    : points_(std::move(corners)), spacing_(spacing), source_(source) {
  triangles_.resize(points_.size() / 3);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i)
    triangles_[i] = {3 * i, 3 * i + 1, 3 * i + 2};
  find_bounds();
  index_rows(samples);
}

void MeshSolid::find_bounds() {
  if (points_.empty()) return;
  Index3 lo = points_[0], hi = points_[0];
  for (const Index3& p : points_) {
    lo = min(lo, p);
    hi = max(hi, p);
  }
  bounds_ = snapped_bounds(lo, hi, spacing_);
}

void MeshSolid::index_rows(const Box3& samples) {
  std::vector<MeshRowIndex::Rows> reached(triangles_.size());
  for (std::size_t along = 0; along < 3; ++along) {
    for (std::uint32_t i = 0; i < triangles_.size(); ++i)
      reached[i] = reached_rows(corners(i), along, samples);
    rows_[along] = MeshRowIndex(reached);
  }
}

std::uint64_t MeshSolid::bytes() const {
  std::uint64_t sum = points_.capacity() * sizeof(Index3) + triangles_.capacity() * 12;
  for (const MeshRowIndex& index : rows_) sum += index.bytes();
  return sum + blocks_.bytes();
}

void MeshSolid::each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const {
  if (samples.empty()) return;
  const MeshRowIndex::Rows wanted{{samples.lo.y, samples.lo.z}, {samples.hi.y, samples.hi.z}};
  rows_[0].each_bin(wanted, [&](const MeshRowIndex::Rows& part, auto triangles) {
    for (const std::uint32_t triangle : triangles) {
      const Corners c = corners(triangle);
      const Range x = range(c, 0);
      if (x.lo > (samples.hi.x - 1) << cell_bits) continue;
      const bool before = x.hi <= samples.lo.x << cell_bits;
      const Range y = samples_in(range(c, 1)), z = samples_in(range(c, 2));
      const Plane plane = plane_of(c);
      for (std::int64_t k = std::max(z.lo, part.lo[1]); k < std::min(z.hi, part.hi[1]); ++k)
        for (std::int64_t j = std::max(y.lo, part.lo[0]); j < std::min(y.hi, part.hi[0]); ++j) {
          const Index3 p{0, j << cell_bits, k << cell_bits};
          if (!meets_row(c, p, 0)) continue;
          const std::int64_t at = before ? samples.lo.x : first_beyond(plane, p);
          if (at < samples.hi.x) flip({std::max(at, samples.lo.x), j, k});
        }
    }
  });
}

std::optional<bool> MeshSolid::side(const Box3& samples) const {
  // Those between the rows along one axis are met by rows along another.
  const std::size_t axes = blocks_.meets(samples) ? 3 : 0;
  for (std::size_t along = 0; along < axes; ++along) {
    const auto [u, v] = axes_across[along];
    bool reached = false;
    rows_[along].each_bin({{samples.lo[u], samples.lo[v]}, {samples.hi[u], samples.hi[v]}},
                          [&](const MeshRowIndex::Rows&, auto triangles) {
                            for (const std::uint32_t triangle : triangles)
                              reached = reached || triangle_reaches(corners(triangle), samples);
                          });
    if (reached) return std::nullopt;
  }
  bool inside = false;
  each_flip({samples.lo, samples.lo + splat(1)}, [&](const Flip&) { inside = !inside; });
  return inside;
}

MeshSolid::Crossing MeshSolid::crossing(int axis, Index3 s, bool low_inside) const {
  const auto a = static_cast<std::size_t>(axis);
  const Index3 low = s * cell;
  Index3 high = low;
  high[axis] += cell;
  const double out = low_inside ? 1 : -1;
  // Were there no crossing, which a closed mesh does not allow, it would be this.
  Crossing found;
  found.normal[axis] = out;
  // Nearest the outside end first; what is equal in that is told by its normal, not by its number.
  const auto rank = [&](const Crossing& c) {
    return std::tuple(out * c.t, c.normal.x, c.normal.y, c.normal.z);
  };
  bool any = false;
  for (const std::uint32_t triangle : rows_[a].at(s[axes_across[a][0]], s[axes_across[a][1]])) {
    const Corners c = corners(triangle);
    const Range along = range(c, axis);
    if (along.lo > high[axis] || along.hi < low[axis] || !meets_row(c, low, axis)) continue;
    const Plane plane = plane_of(c);
    const Wide value = plane.value(low), step = plane.normal[a] << cell_bits;
    if (plane.above(value) == plane.above(value + step)) continue;
    Crossing here;
    here.t = -static_cast<double>(value) / static_cast<double>(step);
    // From steps of the grid to lengths; then unit, and out of the inside end.
    Vec3 n;
    for (int i = 0; i < 3; ++i)
      n[i] = static_cast<double>(plane.normal[static_cast<std::size_t>(i)]) / spacing_[i];
    const double length = std::sqrt(dot(n, n));
    here.normal = n * (((step > 0) == low_inside ? 1 : -1) / length);
    if (!any || rank(here) > rank(found)) found = here;
    any = true;
  }
  return found;
}

}  // namespace voxweld
