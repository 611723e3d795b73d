#include "tests/support/mesh_defects.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <tuple>

#include "stages/exact/intersections.h"

namespace voxweld::testing {
namespace {

using Corners = std::array<std::uint32_t, 3>;

bool repeats_corner(const Corners& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// Side i of triangle t, corner i to corner i + 1, is 3 t + i; so is corner i.
struct Side {
  std::uint32_t low, high;  // vertices
  std::uint32_t number;
  bool upwards;  // runs from low to high

  auto edge() const { return std::pair(low, high); }
};
std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
    const Corners& t = mesh.triangles[k];
    if (repeats_corner(t)) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), 3 * k + i, from < to});
    }
  }
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.low, s.high, s.number); });
  return sides;
}

// Corners that are joined through edges.
class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) : up_(corners) { std::iota(up_.begin(), up_.end(), 0U); }
  std::uint32_t root(std::uint32_t corner) {
    while (up_[corner] != corner) corner = up_[corner] = up_[up_[corner]];
    return corner;
  }
  void join(std::uint32_t a, std::uint32_t b) { up_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> up_;
};

// Counts edges, joins the corners on both sides of each that is manifold, and marks the ends of the
// others.
void go_through_edges(const std::vector<Side>& sides, MeshDefects& found, CornerSets& corners,
                      std::vector<bool>& on_bad_edge) {
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end].edge() == sides[i].edge()) ++end;
    if (end - i == 1) {
      ++found.boundary_edges;
    } else if (end - i == 2 && sides[i].upwards != sides[i + 1].upwards) {
      const std::uint32_t a = sides[i].number, b = sides[i + 1].number;
      corners.join(a, next_corner(b));
      corners.join(next_corner(a), b);
    } else {
      ++found.nonmanifold_edges;
      on_bad_edge[sides[i].low] = on_bad_edge[sides[i].high] = true;
    }
  }
}

std::uint64_t vertices_of_several(const TriangleMesh& mesh, CornerSets& corners,
                                  const std::vector<bool>& on_bad_edge) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> set_of(mesh.vertices.size(), none);
  std::vector<bool> several(mesh.vertices.size());
  for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
    if (repeats_corner(mesh.triangles[k])) continue;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t v = mesh.triangles[k][i], set = corners.root(3 * k + i);
      if (set_of[v] == none) set_of[v] = set;
      if (set_of[v] != set && !on_bad_edge[v]) several[v] = true;
    }
  }
  return static_cast<std::uint64_t>(std::ranges::count(several, true));
}

}  // namespace

TriangleMesh welded(const TriangleMesh& mesh) {
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::vector<std::uint32_t> order(mesh.vertices.size()), becomes(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, before);
  TriangleMesh result;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || before(order[i - 1], order[i]))
      result.vertices.push_back(mesh.vertices[order[i]]);
    becomes[order[i]] = static_cast<std::uint32_t>(result.vertices.size() - 1);
  }
  result.triangles.reserve(mesh.triangles.size());
  for (const Corners& t : mesh.triangles)
    result.triangles.push_back({becomes[t[0]], becomes[t[1]], becomes[t[2]]});
  return result;
}

MeshDefects find_defects(const TriangleMesh& mesh) {
  MeshDefects found;
  CornerSets corners(3 * mesh.triangles.size());
  std::vector<bool> on_bad_edge(mesh.vertices.size());
  go_through_edges(sorted_sides(mesh), found, corners, on_bad_edge);
  found.nonmanifold_vertices = vertices_of_several(mesh, corners, on_bad_edge);
  for (const Corners& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    if (cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a) == Vec3{}) ++found.degenerate;
  }
  return found;
}

ExactDefects find_exact_defects(std::span<const LatticePoint> positions,
                                std::span<const std::array<std::uint32_t, 3>> triangles) {
  const TriangleList list{positions, triangles};
  const std::vector<LatticeBox> boxes = boxes_of(list);
  const BoxTree tree(boxes);
  std::atomic<std::uint64_t> pairs = 0, degenerate = 0;
  // As each_intersection() does it, but on all cores.
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(list.size()), [&](auto i) {
    const LatticeTriangle own = list[i];
    if (has_no_area(own)) ++degenerate;
    tree.each_meeting(boxes[i], [&](std::uint32_t j) {
      if (j > i && intersect_beyond_shared(own, list[j])) ++pairs;
    });
  });
  return {pairs, degenerate};
}

}  // namespace voxweld::testing
