#include "stages/solids/wound_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace voxweld {
namespace {

// In cells: less than the 2^-20 that corners are snapped to, more along x than y than z, as
// MeshSolid has it.
constexpr Vec3 moved_by = {0x1p-22, 0x1p-27, 0x1p-32};
constexpr double grown_by = 1e-6;  // boxes, beyond what rounding may be

// Samples s with lo <= s + moved_by <= hi.
Box3 samples_within(Vec3 lo, Vec3 hi) {
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = static_cast<std::int64_t>(std::ceil(lo[a] - moved_by[a]));
    box.hi[a] = static_cast<std::int64_t>(std::floor(hi[a] - moved_by[a])) + 1;
  }
  return box;
}

// Corners in cells, each axis by its scale; those that are snapped to one place are one.
TriangleMesh scaled_mesh(const TriangleMesh& mesh, Vec3 spacing, Vec3 scale) {
  std::vector<Index3> steps;
  steps.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) steps.push_back(snapped_corner(v, spacing));
  std::vector<std::uint32_t> order(steps.size()), becomes(steps.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [](Index3 a, Index3 b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return before(steps[a], steps[b]); });
  TriangleMesh scaled;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || before(steps[order[i - 1]], steps[order[i]])) {
      Vec3 place = as_vec3(steps[order[i]]) * (1.0 / static_cast<double>(mesh_cell));
      for (int a = 0; a < 3; ++a) place[a] *= scale[a];
      scaled.vertices.push_back(place);
    }
    becomes[order[i]] = static_cast<std::uint32_t>(scaled.vertices.size() - 1);
  }
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> own = {becomes[t[0]], becomes[t[1]], becomes[t[2]]};
    if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) scaled.triangles.push_back(own);
  }
  return scaled;
}

}  // namespace

struct WoundMesh::Edge {
  int axis;
  Index3 low;
  bool low_inside;

  // u: 0 at the outside end, 1 at the inside end.
  double t(double u) const { return low_inside ? 1 - u : u; }
  Vec3 at(double u) const {
    Vec3 index = as_vec3(low);
    index[axis] += t(u);
    return index;
  }
  double out() const { return low_inside ? 1 : -1; }  // along the axis
};

WoundMesh::WoundMesh(const TriangleMesh& mesh, const VolumeFrame& frame, Hash128 source)
    : spacing_(frame.spacing) {
  KeyHasher key;
  source_ = key.hash(source).text("winding 1").finish();
  const double least = std::min({spacing_.x, spacing_.y, spacing_.z});
  scale_ = spacing_ * (1 / least);
  const TriangleMesh scaled = scaled_mesh(mesh, spacing_, scale_);
  winding_ = WindingNumber(scaled);
  bool any = false;
  for (const auto& t : scaled.triangles)
    for (const std::uint32_t corner : t) {
      Vec3 cells = scaled.vertices[corner];
      for (int a = 0; a < 3; ++a) cells[a] /= scale_[a];
      lo_ = any ? min(lo_, cells) : cells;
      hi_ = any ? max(hi_, cells) : cells;
      any = true;
    }
  for (int a = 0; a < 3; ++a) {
    bounds_.lo[a] = lo_[a] * spacing_[a];
    bounds_.hi[a] = hi_[a] * spacing_[a];
  }
}

Vec3 WoundMesh::place(Vec3 index) const {
  Vec3 place;
  for (int a = 0; a < 3; ++a) place[a] = (index[a] + moved_by[a]) * scale_[a];
  return place;
}

bool WoundMesh::holds(Vec3 index) const {
  for (int a = 0; a < 3; ++a)
    if (index[a] + moved_by[a] < lo_[a] || index[a] + moved_by[a] > hi_[a]) return false;
  return winding_.inside(place(index));
}

Relation WoundMesh::side_of(const Box3& samples) const {
  Bounds box{place(as_vec3(samples.lo)), place(as_vec3(samples.hi - splat(1)))};
  for (int a = 0; a < 3; ++a) {
    box.lo[a] -= grown_by;
    box.hi[a] += grown_by;
  }
  return winding_.side_of(box);
}

void WoundMesh::each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const {
  fill(intersect(samples, samples_within(lo_, hi_)), samples.hi.x, flip);
}

// Halves of boxes until each is on one side: rows last, since they are told by two flips.
void WoundMesh::fill(const Box3& samples, std::int64_t end,
                     const std::function<void(const Flip&)>& flip) const {
  if (samples.empty()) return;
  const Index3 size = samples.size();
  Relation side = Relation::mixed;
  if (samples.count() == 1)
    side = holds(as_vec3(samples.lo)) ? Relation::inside : Relation::outside;
  else
    side = side_of(samples);
  if (side == Relation::outside) return;
  if (side == Relation::inside) {
    for (std::int64_t z = samples.lo.z; z < samples.hi.z; ++z)
      for (std::int64_t y = samples.lo.y; y < samples.hi.y; ++y) {
        flip({samples.lo.x, y, z});
        if (samples.hi.x < end) flip({samples.hi.x, y, z});
      }
    return;
  }
  const int axis = size.z >= size.y && size.z >= size.x ? 2 : size.y >= size.x ? 1 : 0;
  Box3 first = samples, second = samples;
  first.hi[axis] = second.lo[axis] = samples.lo[axis] + size[axis] / 2;
  fill(first, end, flip);
  fill(second, end, flip);
}

LatticeSolid::Crossing WoundMesh::crossing(int axis, Index3 s, bool low_inside) const {
  const Edge edge{axis, s, low_inside};
  if (const auto found = at_triangle(edge)) return *found;
  return in_hole(edge);
}

// The triangle nearest the outside end behind which the edge is inside.
std::optional<LatticeSolid::Crossing> WoundMesh::at_triangle(const Edge& edge) const {
  struct Meeting {
    double u;
    Vec3 normal;
  };
  std::vector<Meeting> meetings;
  const double length = scale_[edge.axis];
  winding_.each_meeting(place(as_vec3(edge.low)), edge.axis, length, [&](double t, Vec3 normal) {
    meetings.push_back({edge.t(std::clamp(t, 0.0, 1.0)), normal});
  });
  const auto leads_in = [&](const Meeting& m) { return m.normal[edge.axis] * edge.out() > 0; };
  const auto found = [&](const Meeting& m) { return Crossing{edge.t(m.u), m.normal}; };
  if (meetings.size() == 1 && leads_in(meetings[0])) return found(meetings[0]);
  const auto rank = [](const Meeting& m) {
    return std::tuple(m.u, m.normal.x, m.normal.y, m.normal.z);
  };
  std::sort(meetings.begin(), meetings.end(),
            [&](const Meeting& a, const Meeting& b) { return rank(a) < rank(b); });
  bool inside = false;
  for (std::size_t i = 0; i < meetings.size();) {
    // Those at one place are one step.
    std::size_t next = i;
    const Meeting* into = nullptr;
    for (; next < meetings.size() && meetings[next].u - meetings[i].u < grown_by; ++next)
      if (into == nullptr && leads_in(meetings[next])) into = &meetings[next];
    const double beyond = next < meetings.size() ? meetings[next].u : 1;
    const bool then = holds(edge.at(0.5 * (meetings[next - 1].u + beyond)));
    if (!inside && then && into != nullptr) return found(*into);
    inside = then;
    i = next;
  }
  return std::nullopt;
}

LatticeSolid::Crossing WoundMesh::in_hole(const Edge& edge) const {
  double outside = 0, inside = 1;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (outside + inside);
    (holds(edge.at(middle)) ? inside : outside) = middle;
  }
  const double u = 0.5 * (outside + inside);
  Crossing crossing;
  crossing.t = edge.t(u);
  const Vec3 rise = winding_.gradient(place(edge.at(u)));
  const double steepness = std::sqrt(dot(rise, rise));
  if (rise[edge.axis] * edge.out() < 0)
    crossing.normal = rise * (-1 / steepness);
  else  // the box's side, or a step of rounding: nothing is known but the ends
    crossing.normal[edge.axis] = edge.out();
  return crossing;
}

}  // namespace voxweld
