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

constexpr double least_room_cells = 1.5;

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
  double density = 0;  // triangles a lattice point, where there are most

  void join(const Cluster& other) {
    box.extend(other.box);
    density = std::max(density, other.density);
  }
};

double points_in(const LatticeBox& box) {
  double points = 1;
  for (std::size_t a = 0; a < 3; ++a) points *= static_cast<double>(box.hi[a]) - box.lo[a] + 1;
  return points;
}

// One for each place with its room, but those that begin in the same few cells as one.
std::vector<Cluster> with_room(const std::vector<IntersectionPlace>& places,
                               const RefineFrame& frame, const MendRoom& wanted) {
  const CubeLattice homes(frame, wanted.pass);
  const LatticeBox bounds = homes.bounds();
  const Steps room = steps_of(frame, wanted.cells);
  std::map<Steps, Cluster> clusters;
  for (const IntersectionPlace& place : places) {
    // It is at home in one of them, and where the volume ends there are thin ones.
    const double points = std::max(points_in(homes.box(homes.cube_of(place.box.lo))),
                                   points_in(homes.box(homes.cube_of(place.box.hi))));
    Cluster grown{place.box, static_cast<double>(place.around) / points};
    Steps at{};
    const auto length = static_cast<std::int32_t>(wanted.lengths * longest_side(place.box));
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

// Whether it may hold more triangles than are done at once, were they spread evenly over their cubes.
bool is_large(const Cluster& cluster) {
  return points_in(cluster.box) * cluster.density > static_cast<double>(most_part_triangles);
}

MendRoom with_half(MendRoom room) {
  room.cells /= 2;
  return room;
}

class MendBoxes {
 public:
  MendBoxes(const RefineFrame& frame, int cut)
      : frame_(frame), cubes_(frame, cut, frame.level - 1) {}

  // What is too large with so much room has less, and is cut where there is no less.
  void add(std::vector<IntersectionPlace> places, const MendRoom& room) {
    const std::vector<Cluster> clusters = apart(with_room(places, frame_, room));
    auto large = places_of_large(clusters, places);
    places = {};  // there may be very many, and less room makes copies of its own
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
      const auto found = large.find(i);
      if (found == large.end())
        boxes_.push_back(clusters[i].box);
      else if (room.cells > least_room_cells)
        add(std::move(found->second), with_half(room));
      else
        add_cubes(clusters[i].box, found->second);
    }
  }
  std::vector<LatticeBox> take() {
    std::ranges::sort(boxes_, {}, &LatticeBox::lo);
    return std::move(boxes_);
  }

 private:
  // By the numbers of the clusters.
  static std::map<std::uint32_t, std::vector<IntersectionPlace>> places_of_large(
      const std::vector<Cluster>& clusters, const std::vector<IntersectionPlace>& places) {
    std::vector<std::uint32_t> large;  // few, if any
    std::vector<LatticeBox> boxes;
    for (std::uint32_t i = 0; i < clusters.size(); ++i)
      if (is_large(clusters[i])) {
        large.push_back(i);
        boxes.push_back(clusters[i].box);
      }
    std::map<std::uint32_t, std::vector<IntersectionPlace>> found;
    if (large.empty()) return found;
    const BoxTree tree(boxes);
    for (const IntersectionPlace& place : places)
      tree.each_meeting(place.box, [&](std::uint32_t i) { found[large[i]].push_back(place); });
    return found;
  }
  // The cubes with places in them.
  void add_cubes(const LatticeBox& box, const std::vector<IntersectionPlace>& places) {
    std::set<std::uint64_t> found;
    for (const IntersectionPlace& place : places) {
      const Index3 lo = cubes_.cube_of(place.box.lo), hi = cubes_.cube_of(place.box.hi);
      each_index({lo, hi + splat(1)}, [&](Index3 at) { found.insert(morton_encode(at)); });
    }
    for (const std::uint64_t at : found)
      boxes_.push_back(box.common(cubes_.box(morton_decode(at))));
  }

  const RefineFrame& frame_;
  CubeLattice cubes_;
  std::vector<LatticeBox> boxes_;
};

}  // namespace

std::vector<LatticeBox> mend_boxes(std::vector<IntersectionPlace> places, const RefineFrame& frame,
                                   const MendRoom& room) {
  MendBoxes boxes(frame, room.cut);
  boxes.add(std::move(places), room);
  return boxes.take();
}

std::vector<LatticeBox> mend_boxes_within(const std::vector<IntersectionPlace>& places,
                                          const RefineFrame& frame, const MendRoom& room,
                                          const CubeLattice& cubes) {
  std::map<std::uint64_t, std::vector<IntersectionPlace>> by_cube;  // Morton numbers
  for (const IntersectionPlace& place : places)
    if (const Index3 cube = cubes.cube_of(place.box.lo); cube == cubes.cube_of(place.box.hi))
      by_cube[morton_encode(cube)].push_back(place);
  std::vector<LatticeBox> all;
  for (const auto& [cube, inside] : by_cube) {
    const LatticeBox borders = cubes.box(morton_decode(cube));
    for (const LatticeBox& box : mend_boxes(inside, frame, room))
      all.push_back(box.common(borders));
  }
  std::ranges::sort(all, {}, &LatticeBox::lo);
  return all;
}

}  // namespace voxweld
