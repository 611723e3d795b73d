#include "stages/solids/winding_number.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace voxweld {
namespace {

constexpr double infinite_reach = std::numeric_limits<double>::infinity();
constexpr double full_angle = 4 * std::numbers::pi;
constexpr std::uint32_t leaf_triangles = 8;
// So many open edges are summed up whole at each point in doubt.
constexpr std::size_t few_edges = std::size_t{1} << 14;
// Error a cluster may add where one look is to do, and the least there is any use in.
constexpr double rough = 2e-3, finest = 1e-12;

double length_of(Vec3 v) {
  return std::sqrt(dot(v, v));
}

// Of t in [0, 1], from IEEE operations alone: libraries differ in the last bit. Two half angles,
// then the series, whose first term left out is below 1e-18.
double arctangent_of_part(double t) {
  t = t / (1 + std::sqrt(1 + t * t));
  t = t / (1 + std::sqrt(1 + t * t));
  const double s = t * t;
  double sum = 0;
  for (int k = 12; k >= 0; --k) sum = (k % 2 == 0 ? 1.0 : -1.0) / (2 * k + 1) + s * sum;
  return 4 * t * sum;
}

double arctangent(double y, double x) {
  const double a = std::abs(y), b = std::abs(x);
  if (a == 0 && b == 0) return 0;
  double angle =
      a <= b ? arctangent_of_part(a / b) : std::numbers::pi / 2 - arctangent_of_part(b / a);
  if (x < 0) angle = std::numbers::pi - angle;
  return y < 0 ? -angle : angle;
}

// That the triangle takes as seen from 0; positive where it is seen from behind.
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = length_of(a), lb = length_of(b), lc = length_of(c);
  return 2 * arctangent(dot(a, cross(b, c)),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

// Of the harmonic function 1 / |p - y| expanded about the middle of all y: the gradient of the term
// of degree k in y is at most k |y|^(k-1) / D^(k+1) (Bernstein's inequality for the Legendre
// polynomials). What is behind the first two terms of the dipoles' field is at most this, times
// area / D^2, with ratio = radius / D.
double rest_of_expansion(double ratio) {
  if (ratio >= 1) return infinite_reach;
  return ratio * ratio * (3 - 2 * ratio) / ((1 - ratio) * (1 - ratio));
}

// Dipoles at a distance d change by at most 2 / d^3 of their area on a step of 1.
double change_of_dipoles(double area, double distance, double reach) {
  if (reach == 0) return 0;
  const double least = distance - reach;
  return least > 0 ? reach * 2 * area / (full_angle * least * least * least) : infinite_reach;
}

double distance_to_edge(Vec3 p, Vec3 from, Vec3 to) {
  const Vec3 d = to - from;
  const double square = dot(d, d);
  const double t = square > 0 ? std::clamp(dot(p - from, d) / square, 0.0, 1.0) : 0;
  return length_of(p - from - d * t);
}

Bounds bounds_of_corners(const std::array<Vec3, 3>& c) {
  return {min(min(c[0], c[1]), c[2]), max(max(c[0], c[1]), c[2])};
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int i = 0; i < 3; ++i)
    if (a.lo[i] > b.hi[i] || a.hi[i] < b.lo[i]) return false;
  return true;
}

// Whether all of the box is on one side of the triangle's plane.
bool clear_of_plane(const std::array<Vec3, 3>& c, const Bounds& box) {
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const Vec3 middle = (box.lo + box.hi) * 0.5, half = (box.hi - box.lo) * 0.5;
  const double reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
  return std::abs(dot(n, middle - c[0])) > reach * (1 + 1e-12) + 1e-12 * length_of(n);
}

bool before(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  for (std::size_t i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (a[i][axis] != b[i][axis]) return a[i][axis] < b[i][axis];
  return false;
}

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const std::size_t first =
        static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
    triangles_.push_back({{mesh.vertices[t[first]], mesh.vertices[t[(first + 1) % 3]],
                           mesh.vertices[t[(first + 2) % 3]]}});
  }
  std::sort(triangles_.begin(), triangles_.end(),
            [](const Triangle& a, const Triangle& b) { return before(a.corners, b.corners); });
  if (triangles_.empty()) return;
  build(0, static_cast<std::uint32_t>(triangles_.size()));
  find_open_edges(mesh);
  double volume = 0;
  for (const auto& [c] : triangles_) volume += dot(c[0] - apex_, cross(c[1] - apex_, c[2] - apex_));
  orientation_ = volume < 0 ? -1 : 1;
}

void WindingNumber::find_open_edges(const TriangleMesh& mesh) {
  struct Use {
    std::uint32_t low, high;
    int count;  // of low to high, less those of high to low
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  for (std::size_t i = 0; i < uses.size();) {
    const Use& edge = uses[i];
    int count = 0;
    for (; i < uses.size() && uses[i].low == edge.low && uses[i].high == edge.high; ++i)
      count += uses[i].count;
    if (count == 0) continue;
    const Vec3 low = mesh.vertices[edge.low], high = mesh.vertices[edge.high];
    edges_.push_back({count > 0 ? low : high, count > 0 ? high : low, std::abs(1.0 * count)});
  }
  apex_ = clusters_[0].center;
  if (edges_.empty()) return;
  apex_ = {};
  for (const OpenEdge& e : edges_)
    apex_ = apex_ + (e.from + e.to) * (0.5 / static_cast<double>(edges_.size()));
  edges_center_ = apex_;
  for (const OpenEdge& e : edges_) {
    edges_radius_ = std::max({edges_radius_, length_of(e.from - apex_), length_of(e.to - apex_)});
    edges_length_ += e.count * length_of(e.to - e.from);
  }
}

std::uint32_t WindingNumber::build(std::uint32_t begin, std::uint32_t end) {
  const auto at = static_cast<std::uint32_t>(clusters_.size());
  clusters_.push_back(summary(begin, end));
  if (end - begin <= leaf_triangles) {
    // One order, however the halves were found.
    std::sort(triangles_.begin() + begin, triangles_.begin() + end,
              [](const Triangle& a, const Triangle& b) { return before(a.corners, b.corners); });
    return at;
  }
  const Vec3 size = clusters_[at].bounds.hi - clusters_[at].bounds.lo;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto place = [&](const Triangle& t) {
    return t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis];
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end, [&](const Triangle& a, const Triangle& b) {
                     const double pa = place(a), pb = place(b);
                     return pa != pb ? pa < pb : before(a.corners, b.corners);
                   });
  build(begin, middle);
  const std::uint32_t other = build(middle, end);
  clusters_[at].other = other;
  return at;
}

WindingNumber::Cluster WindingNumber::summary(std::uint32_t begin, std::uint32_t end) const {
  Cluster cluster;
  cluster.begin = begin;
  cluster.end = end;
  cluster.bounds = bounds_of_corners(triangles_[begin].corners);
  Vec3 sum;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto& c = triangles_[i].corners;
    const double area = 0.5 * length_of(cross(c[1] - c[0], c[2] - c[0]));
    cluster.area += area;
    sum = sum + (c[0] + c[1] + c[2]) * (area / 3);
    const Bounds b = bounds_of_corners(c);
    cluster.bounds = {min(cluster.bounds.lo, b.lo), max(cluster.bounds.hi, b.hi)};
  }
  cluster.center =
      cluster.area > 0 ? sum * (1 / cluster.area) : (cluster.bounds.lo + cluster.bounds.hi) * 0.5;
  auto& m = cluster.moment;
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto& c = triangles_[i].corners;
    const Vec3 n = cross(c[1] - c[0], c[2] - c[0]) * 0.5;
    const Vec3 u = (c[0] + c[1] + c[2]) * (1.0 / 3) - cluster.center;
    cluster.normal = cluster.normal + n;
    const std::array<double, 6> own = {u.x * n.x,
                                       u.y * n.y,
                                       u.z * n.z,
                                       u.x * n.y + u.y * n.x,
                                       u.x * n.z + u.z * n.x,
                                       u.y * n.z + u.z * n.y};
    for (std::size_t k = 0; k < 6; ++k) m[k] += own[k];
    for (const Vec3& v : c)
      cluster.radius = std::max(cluster.radius, length_of(v - cluster.center));
  }
  return cluster;
}

void WindingNumber::add(std::uint32_t at, Vec3 p, double reach, double each, Sum& sum) const {
  const Cluster& cluster = clusters_[at];
  const Vec3 d = cluster.center - p;
  const double square = dot(d, d), distance = std::sqrt(square);
  const double change = change_of_dipoles(cluster.area, distance - cluster.radius, reach);
  const double rest =
      cluster.area / (full_angle * square) * rest_of_expansion(cluster.radius / distance);
  if (rest + change <= each) {
    const auto& m = cluster.moment;
    const double cube = square * distance;
    const double along = m[0] * d.x * d.x + m[1] * d.y * d.y + m[2] * d.z * d.z + m[3] * d.x * d.y +
                         m[4] * d.x * d.z + m[5] * d.y * d.z;
    sum.value +=
        (dot(cluster.normal, d) + m[0] + m[1] + m[2] - 3 * along / square) / (cube * full_angle);
    sum.error += rest + change;
  } else if (cluster.other != 0) {
    add(at + 1, p, reach, each, sum);
    add(cluster.other, p, reach, each, sum);
  } else {
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      const auto& c = triangles_[i].corners;
      sum.value += solid_angle(c[0] - p, c[1] - p, c[2] - p) / full_angle;
    }
    sum.error += change;
  }
}

// At p, where each cluster may add so much error; with a reach, of all points within it.
WindingNumber::Sum WindingNumber::estimate(Vec3 p, double reach, double each) const {
  Sum sum;
  if (!clusters_.empty()) add(0, p, reach, each, sum);
  sum.value *= orientation_;
  return sum;
}

// Of the fan that closes the mesh: its edges are the open ones, the other way round.
double WindingNumber::fan_angle(Vec3 p) const {
  double sum = 0;
  const Vec3 o = apex_ - p;
  for (const OpenEdge& e : edges_) sum += e.count * solid_angle(e.to - p, e.from - p, o);
  return sum / full_angle * orientation_;
}

double WindingNumber::value(Vec3 p) const {
  const bool few = edges_.size() <= few_edges;
  double each = rough;
  Sum sum = estimate(p, 0, each);
  while (sum.error > (few ? 0.4 : 1e-6) && each > finest) sum = estimate(p, 0, each /= 16);
  if (!few) return sum.value;
  if (edges_.empty()) return std::round(sum.value);
  const double fan = fan_angle(p);
  return std::round(sum.value + fan) - fan;
}

bool WindingNumber::inside(Vec3 p) const {
  Sum sum = estimate(p, 0, rough);
  if (std::abs(sum.value - 0.5) > sum.error + 1e-9) return sum.value > 0.5;
  if (edges_.size() <= few_edges) return value(p) >= 0.5;
  for (double each = rough / 16; std::abs(sum.value - 0.5) <= sum.error && each > finest;
       each /= 16)
    sum = estimate(p, 0, each);
  return sum.value >= 0.5;
}

// How far the number may change between p and points within reach, no triangle between them: the
// field of a wire along the open edges (Biot, Savart) is no stronger than the sum of count * length
// / distance^2 / 4 pi.
double WindingNumber::change_within(Vec3 p, double reach) const {
  if (edges_.empty()) return 0;
  const double away = length_of(p - edges_center_) - edges_radius_ - reach;
  if (away > 0) {
    const double most = reach * edges_length_ / (full_angle * away * away);
    if (most < 0.1) return most;
  }
  double sum = 0;
  for (const OpenEdge& e : edges_) {
    const double least = distance_to_edge(p, e.from, e.to) - reach;
    if (least <= 0) return infinite_reach;
    sum += e.count * std::min(length_of(e.to - e.from) / least, std::numbers::pi) / least;
  }
  return reach * sum / full_angle;
}

Relation WindingNumber::side_of(const Bounds& box) const {
  if (touches(box)) return Relation::mixed;
  const Vec3 middle = (box.lo + box.hi) * 0.5;
  const double reach = 0.5 * length_of(box.hi - box.lo);
  const bool few = edges_.size() <= few_edges;
  const double change = few ? change_within(middle, reach) : 0;
  if (change >= 1) return Relation::mixed;
  Sum sum = estimate(middle, few ? 0 : reach, rough);
  if (few && std::abs(sum.value - 0.5) <= sum.error + change + 1e-9) sum = {value(middle), 0};
  if (!(std::abs(sum.value - 0.5) > sum.error + change + 1e-9)) return Relation::mixed;
  return sum.value > 0.5 ? Relation::inside : Relation::outside;
}

bool WindingNumber::touches(const Bounds& box) const {
  bool any = false;
  each_near(box, [&](const Triangle& t) {
    any = overlap(bounds_of_corners(t.corners), box) && !clear_of_plane(t.corners, box);
    return !any;
  });
  return any;
}

std::optional<WindingNumber::Meeting> WindingNumber::meeting(const Triangle& triangle, Vec3 from,
                                                             int axis, double length) {
  const auto& c = triangle.corners;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  // On which side of each side of the triangle the line runs, seen along it: the same number for
  // both triangles of an edge.
  const auto side = [&](Vec3 a, Vec3 b) {
    const bool turned = std::pair(b[u], b[v]) < std::pair(a[u], a[v]);
    if (turned) std::swap(a, b);
    const double area = (b[u] - a[u]) * (from[v] - a[v]) - (b[v] - a[v]) * (from[u] - a[u]);
    return turned ? -area : area;
  };
  const double first = side(c[0], c[1]), second = side(c[1], c[2]), third = side(c[2], c[0]);
  const bool left = first > 0 && second > 0 && third > 0;
  if (!left && !(first < 0 && second < 0 && third < 0)) return std::nullopt;
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const double t = dot(n, c[0] - from) / (n[axis] * length);
  if (!(t >= 0 && t <= 1)) return std::nullopt;
  return Meeting{t, n * (1 / length_of(n))};
}

// The field of a unit current along an edge: in closed form (a x b) (|a| + |b|) / (|a| |b| (|a| |b|
// + a . b)) with a, b from p to its ends.
Vec3 WindingNumber::gradient(Vec3 p) const {
  Vec3 sum;
  for (const OpenEdge& e : edges_) {
    const Vec3 a = e.from - p, b = e.to - p;
    const double la = length_of(a), lb = length_of(b);
    const double below = la * lb * (la * lb + dot(a, b));
    if (below > 0) sum = sum + cross(a, b) * (e.count * (la + lb) / below);
  }
  return sum * (orientation_ / full_angle);
}

std::uint64_t WindingNumber::bytes() const {
  return triangles_.capacity() * sizeof(Triangle) + clusters_.capacity() * sizeof(Cluster) +
         edges_.capacity() * sizeof(OpenEdge);
}

}  // namespace voxweld
