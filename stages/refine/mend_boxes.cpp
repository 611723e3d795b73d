#include "stages/refine/mend_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "stages/exact/box_tree.h"
#include "stages/refine/box_refiner.h"
#include "storage/types/morton.h"

namespace voxweld {
namespace {

constexpr double room_cells = 12;  // around a triangle, and as much again as it is long

using Steps = std::array<std::int32_t, 3>;

// So many cells of the volume, in lattice steps.
Steps steps_of(const RefineFrame& frame, double cells) {
  Steps steps{};
  for (int axis = 0; axis < 3; ++axis) {
    const double exact = std::ceil(cells * frame.spacing[axis] / frame.lattice.step);
    steps[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(std::max(1.0, exact));
  }
  return steps;
}

std::int32_t longest_side(const LatticeBox& box) {
  return std::max({box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]});
}

struct Cluster {
  LatticeBox box;
  std::uint64_t around = 0;

  void join(const Cluster& other) {
    box.extend(other.box);
    around = std::max(around, other.around);
  }
};

// One for each place with its room, but those that begin in the same few cells as one.
std::vector<Cluster> with_room(const std::vector<IntersectionPlace>& places,
                               const RefineFrame& frame, const LatticeBox& bounds) {
  const Steps room = steps_of(frame, room_cells);
  std::map<Steps, Cluster> clusters;
  for (const IntersectionPlace& place : places) {
    Cluster grown{place.box, place.around};
    Steps at{};
    const std::int32_t length = longest_side(place.box);
    for (std::size_t a = 0; a < 3; ++a) {
      grown.box.lo[a] = std::max(bounds.lo[a], place.box.lo[a] - room[a] - length);
      grown.box.hi[a] = std::min(bounds.hi[a], place.box.hi[a] + room[a] + length);
      at[a] = place.box.lo[a] / (4 * room[a]);
    }
    const auto [found, is_new] = clusters.try_emplace(at, grown);
    if (!is_new) found->second.join(grown);
  }
  std::vector<Cluster> list;
  list.reserve(clusters.size());
  for (const auto& [at, cluster] : clusters) list.push_back(cluster);
  return list;
}

std::vector<LatticeBox> boxes_of(const std::vector<Cluster>& clusters) {
  std::vector<LatticeBox> boxes;
  boxes.reserve(clusters.size());
  for (const Cluster& cluster : clusters) boxes.push_back(cluster.box);
  return boxes;
}

// Numbers that are joined have one root, the lowest of them.
class Groups {
 public:
  explicit Groups(std::size_t count) : above_(count) {
    std::iota(above_.begin(), above_.end(), 0U);
  }
  std::uint32_t root(std::uint32_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> above_;
};

// Those that meet as one; which may meet others then.
std::vector<Cluster> joined_once(const std::vector<Cluster>& clusters) {
  const std::vector<LatticeBox> boxes = boxes_of(clusters);
  const BoxTree tree(boxes);
  Groups groups(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    tree.each_meeting(boxes[i], [&](std::uint32_t j) { groups.join(i, j); });
  std::map<std::uint32_t, Cluster> joined;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const auto [found, is_new] = joined.try_emplace(groups.root(i), clusters[i]);
    if (!is_new) found->second.join(clusters[i]);
  }
  std::vector<Cluster> list;
  list.reserve(joined.size());
  for (const auto& [root, cluster] : joined) list.push_back(cluster);
  return list;
}

std::vector<Cluster> apart(std::vector<Cluster> clusters) {
  for (;;) {
    std::vector<Cluster> joined = joined_once(clusters);
    if (joined.size() == clusters.size()) return clusters;
    clusters = std::move(joined);
  }
}

// About how many triangles lie in it, were they spread evenly over their cubes.
double triangles_in(const Cluster& cluster, const Steps& cube) {
  double cubes = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double side = static_cast<double>(cluster.box.hi[a]) - cluster.box.lo[a];
    cubes *= (side + 1) / cube[a];
  }
  return cubes * static_cast<double>(cluster.around);
}

LatticeBox common_part(const LatticeBox& a, const LatticeBox& b) {
  LatticeBox common;
  for (std::size_t i = 0; i < 3; ++i) {
    common.lo[i] = std::max(a.lo[i], b.lo[i]);
    common.hi[i] = std::min(a.hi[i], b.hi[i]);
  }
  return common;
}

// Of clusters that hold too much, by their numbers, the cubes with places in them.
std::map<std::uint32_t, std::set<std::uint64_t>> cubes_of_large(
    const std::vector<Cluster>& clusters, const std::vector<IntersectionPlace>& places,
    const Steps& cube, const CubeLattice& cubes) {
  const BoxTree tree(boxes_of(clusters));
  std::map<std::uint32_t, std::set<std::uint64_t>> found;
  for (const IntersectionPlace& place : places)
    tree.each_meeting(place.box, [&](std::uint32_t i) {
      if (triangles_in(clusters[i], cube) <= static_cast<double>(most_part_triangles)) return;
      const Index3 lo = cubes.cube_of(place.box.lo), hi = cubes.cube_of(place.box.hi);
      each_index({lo, hi + splat(1)}, [&](Index3 at) { found[i].insert(morton_encode(at)); });
    });
  return found;
}

}  // namespace

std::vector<LatticeBox> mend_boxes(const std::vector<IntersectionPlace>& places,
                                   const RefineFrame& frame) {
  // Not near where the passes cut their cubes.
  const CubeLattice cubes(frame, 1, frame.level - 1);
  const std::vector<Cluster> clusters = apart(with_room(places, frame, cubes.bounds()));
  const Steps cube = steps_of(frame, static_cast<double>(std::int64_t{1} << frame.level));
  const auto large = cubes_of_large(clusters, places, cube, cubes);
  std::vector<LatticeBox> boxes;
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    const auto cut = large.find(i);
    if (cut == large.end()) {
      boxes.push_back(clusters[i].box);
      continue;
    }
    for (const std::uint64_t at : cut->second)
      boxes.push_back(common_part(clusters[i].box, cubes.box(morton_decode(at))));
  }
  std::ranges::sort(boxes, {}, &LatticeBox::lo);
  return boxes;
}

}  // namespace voxweld
