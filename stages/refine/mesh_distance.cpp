#include "stages/refine/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "stages/exact/orientation.h"
#include "stages/refine/nearest_triangle.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

// Triangles in a group. Those that follow each other in a mesh lie near each other, mostly.
constexpr std::size_t group_size = 8;
// What one thread measures before it takes more.
constexpr std::size_t batch = 4096;

std::vector<LatticeBox> group_boxes(const RefineMesh& mesh) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<LatticeBox> boxes((triangles + group_size - 1) / group_size);
  for_each_index((boxes.size() + batch - 1) / batch, [&](std::size_t i) {
    for (std::size_t g = i * batch; g < std::min((i + 1) * batch, boxes.size()); ++g) {
      const std::size_t first = g * group_size;
      boxes[g] = mesh.box(first);
      for (std::size_t t = first + 1; t < std::min(first + group_size, triangles); ++t)
        boxes[g].extend(mesh.box(t));
    }
  });
  return boxes;
}

LatticePoint middle(const LatticePoint& a, const LatticePoint& b) {
  LatticePoint p{};
  for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + (b[k] - a[k]) / 2;
  return p;
}

LatticePoint centroid(const LatticeTriangle& shape) {
  LatticePoint p{};
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = shape[0][k] + ((shape[1][k] - shape[0][k]) + (shape[2][k] - shape[0][k])) / 3;
  return p;
}

double length(const LatticePoint& a, const LatticePoint& b) {
  const Vec3 v = as_vec3(lattice_vector(a, b));
  return std::sqrt(dot(v, v));
}

// Holds all that is no farther from the point.
LatticeBox box_around(const LatticePoint& point, double distance) {
  const auto step = static_cast<std::int32_t>(std::min(std::ceil(distance), 1e9)) + 1;
  LatticeBox box{point, point};
  for (std::size_t k = 0; k < 3; ++k) {
    box.lo[k] -= step;
    box.hi[k] += step;
  }
  return box;
}

// Sums of integers do not depend on the order.
double mean_edge(const RefineMesh& mesh) {
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const LatticeTriangle s = mesh.shape(t);
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<std::uint64_t>(std::ceil(length(s[k], s[(k + 1) % 3])));
  }
  return static_cast<double>(sum) /
         static_cast<double>(3 * std::max<std::size_t>(mesh.triangles.size(), 1));
}

class Measure {
 public:
  Measure(const RefineMesh& from, MeasuredPoints points, const MeshDistance& to)
      : from_(from),
        to_(to),
        all_(points == MeasuredPoints::all),
        long_edge_(2 * std::max(mean_edge(from), 1.0)) {}

  // How many vertices and triangles there are to measure.
  std::size_t size() const { return vertices() + from_.triangles.size(); }
  // The largest squared distance of those from `begin` on and before `end`, if that is more than `most`.
  double of(std::size_t begin, std::size_t end, double most) const {
    MeshDistance::Hint hint;
    for (std::size_t i = begin; i < end; ++i)
      most = i < vertices() ? to_.squared_beyond(from_.positions[i], most, hint)
                            : of_triangle(i - vertices(), most, hint);
    return most;
  }

 private:
  std::size_t vertices() const { return all_ ? from_.positions.size() : 0; }
  double of_triangle(std::size_t t, double most, MeshDistance::Hint& hint) const {
    const auto ids = from_.ids_of(t);
    const LatticeTriangle shape = from_.shape(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      // Most edges have two triangles, which see them from different ends.
      if (ids[next] < ids[k]) continue;
      if (all_ || length(shape[k], shape[next]) > long_edge_)
        most = to_.squared_beyond(middle(shape[k], shape[next]), most, hint);
    }
    return all_ ? of_inside(shape, most, hint) : most;
  }
  // A large triangle is cut into four, until parts are as small as others.
  double of_inside(const LatticeTriangle& s, double most, MeshDistance::Hint& hint) const {
    most = to_.squared_beyond(centroid(s), most, hint);
    if (std::max({length(s[0], s[1]), length(s[1], s[2]), length(s[2], s[0])}) <= long_edge_)
      return most;
    const LatticePoint ab = middle(s[0], s[1]), bc = middle(s[1], s[2]), ca = middle(s[2], s[0]);
    for (const LatticePoint& p : {ab, bc, ca}) most = to_.squared_beyond(p, most, hint);
    for (const LatticeTriangle& part :
         {LatticeTriangle{s[0], ab, ca}, LatticeTriangle{ab, s[1], bc},
          LatticeTriangle{ca, bc, s[2]}, LatticeTriangle{ab, bc, ca}})
      most = of_inside(part, most, hint);
    return most;
  }

  const RefineMesh& from_;
  const MeshDistance& to_;
  const bool all_;
  const double long_edge_;
};

}  // namespace

MeshDistance::MeshDistance(const RefineMesh& mesh) : mesh_(mesh), groups_(group_boxes(mesh)) {}

std::uint64_t MeshDistance::bytes(std::uint64_t triangles) {
  const std::uint64_t groups = triangles / group_size + 1;
  return groups * (3 * sizeof(LatticeBox) + 2 * sizeof(std::uint64_t));
}

// The squared distance of the group's triangles that meet the box; it ends at the first within `enough`.
double MeshDistance::nearest_in(std::uint32_t group, const LatticePoint& point,
                                const LatticeBox& box, double enough) const {
  double best = std::numeric_limits<double>::infinity();
  const std::size_t begin = group * group_size;
  const std::size_t end = std::min(begin + group_size, mesh_.triangles.size());
  for (std::size_t t = begin; t < end && best > enough; ++t) {
    const LatticeTriangle shape = mesh_.shape(t);
    if (LatticeBox::around(shape).meets(box)) best = std::min(best, squared_distance(point, shape));
  }
  return best;
}

double MeshDistance::beyond(const LatticePoint& point, double least) const {
  Hint hint;
  const double found = squared_beyond(point, least * least, hint);
  return found > least * least ? std::sqrt(found) : least;
}

double MeshDistance::squared_beyond(const LatticePoint& point, double least, Hint& hint) const {
  if (mesh_.triangles.empty()) return least;
  double best = std::numeric_limits<double>::infinity();
  double around = std::max(std::sqrt(least), 1.0);
  LatticeBox box;
  const auto is_near = [&](std::uint32_t group) {
    best = std::min(best, nearest_in(group, point, box, least));
    return best <= least;
  };
  // Boxes that get wider until what is nearest must lie in one.
  for (;; around *= 2) {
    box = box_around(point, around);
    if (groups_.any_meeting_near(box, hint.place, is_near)) return least;
    const double step = static_cast<double>(box.hi[0]) - point[0];
    if (best <= step * step) return best;
  }
}

// Parts of the points begin with the largest distance that is known by then. Which that is does not matter:
// each of them gives the larger of that and its own.
double largest_distance(const RefineMesh& from, MeasuredPoints points, const MeshDistance& to,
                        double least) {
  const Measure measure(from, points, to);
  double most = least * least;
  std::mutex mutex;
  const auto known = [&](double here) {
    const std::scoped_lock lock(mutex);
    return most = std::max(most, here);
  };
  for_each_index((measure.size() + batch - 1) / batch, [&](std::size_t i) {
    known(measure.of(i * batch, std::min((i + 1) * batch, measure.size()), known(0)));
  });
  return most > least * least ? std::sqrt(most) : least;
}

}  // namespace voxweld
