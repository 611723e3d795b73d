// The distance from points to a mesh, through a tree of boxes.
#pragma once

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {

// Of four branches, without pointers: node i of a level holds the nodes 4 i .. 4 i + 3 of the level
// below, or those triangles of the order. The mesh must live as long.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.triangles.empty()) return;
    order_triangles();
    std::vector<Box> boxes;
    boxes.reserve(mesh.triangles.size());
    for (const std::uint32_t i : order_) boxes.push_back(box_of(i));
    do {
      boxes = joined(boxes);
      levels_.push_back(boxes);
    } while (boxes.size() > 1);
  }

  // In the mesh's own units; infinite of a mesh without triangles.
  double distance_to(Vec3 p) const {
    double least = std::numeric_limits<double>::infinity();
    if (!levels_.empty()) visit(levels_.size() - 1, 0, p, least);
    return std::sqrt(least);
  }

 private:
  static constexpr std::size_t branches = 4, worth_a_task = 4096;

  struct Box {
    // Floats hold what is rounded outward in half the memory.
    std::array<float, 3> lo, hi;
  };

  static Box joined(const Box& a, const Box& b) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lo[k] = std::min(a.lo[k], b.lo[k]);
      box.hi[k] = std::max(a.hi[k], b.hi[k]);
    }
    return box;
  }
  static std::vector<Box> joined(const std::vector<Box>& below) {
    std::vector<Box> level;
    level.reserve(below.size() / branches + 1);
    for (std::size_t i = 0; i < below.size(); ++i)
      if (i % branches == 0)
        level.push_back(below[i]);
      else
        level.back() = joined(level.back(), below[i]);
    return level;
  }
  // Squared, as all below.
  static double distance_to(Vec3 lo, Vec3 hi, Vec3 p) {
    const Vec3 off = max(max(lo - p, p - hi), {});
    return dot(off, off);
  }
  static double distance_to(const Box& box, Vec3 p) {
    return distance_to({box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}, p);
  }

  Box box_of(std::uint32_t triangle) const {
    const auto& t = mesh_.triangles[triangle];
    const Vec3 a = mesh_.vertices[t[0]], b = mesh_.vertices[t[1]], c = mesh_.vertices[t[2]];
    const Vec3 lo = min(a, min(b, c)), hi = max(a, max(b, c));
    constexpr float far = std::numeric_limits<float>::infinity();
    Box box;
    for (int k = 0; k < 3; ++k) {
      box.lo[static_cast<std::size_t>(k)] = std::nextafter(static_cast<float>(lo[k]), -far);
      box.hi[static_cast<std::size_t>(k)] = std::nextafter(static_cast<float>(hi[k]), far);
    }
    return box;
  }

  // Halves that lie apart along the longest axis, and so on; each but the last of a level is full.
  using Middles = std::vector<std::array<float, 3>>;
  static void arrange(const Middles& middles, std::span<std::uint32_t> triangles) {
    if (triangles.size() <= branches) return;
    std::array<float, 3> lo = middles[triangles[0]], hi = lo;
    for (const std::uint32_t i : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], middles[i][k]);
        hi[k] = std::max(hi[k], middles[i][k]);
      }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
    const std::size_t half = std::bit_ceil(triangles.size()) / 2;
    std::ranges::nth_element(triangles, triangles.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](std::uint32_t i) { return middles[i][axis]; });
    const auto first = [&] { arrange(middles, triangles.first(half)); };
    const auto last = [&] { arrange(middles, triangles.subspan(half)); };
    if (half < worth_a_task) return first(), last();
    tbb::parallel_invoke(first, last);
  }
  void order_triangles() {
    Middles middles;
    middles.reserve(mesh_.triangles.size());
    for (const auto& t : mesh_.triangles) {
      const Vec3 sum = mesh_.vertices[t[0]] + mesh_.vertices[t[1]] + mesh_.vertices[t[2]];
      middles.push_back(
          {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)});
    }
    order_.resize(mesh_.triangles.size());
    std::iota(order_.begin(), order_.end(), 0U);
    arrange(middles, order_);
  }

  void look_at(std::uint32_t triangle, Vec3 p, double& least) const {
    const auto& t = mesh_.triangles[triangle];
    const Vec3 a = mesh_.vertices[t[0]], b = mesh_.vertices[t[1]], c = mesh_.vertices[t[2]];
    if (distance_to(min(a, min(b, c)), max(a, max(b, c)), p) < least)
      least = std::min(least, square_distance(p, a, b, c));
  }

  void visit(std::size_t level, std::size_t at, Vec3 p, double& least) const {
    const std::size_t below = level == 0 ? order_.size() : levels_[level - 1].size();
    const std::size_t begin = at * branches, end = std::min(begin + branches, below);
    if (level == 0) {
      for (std::size_t i = begin; i < end; ++i) look_at(order_[i], p, least);
      return;
    }
    // The nearest first: it leaves least to look at in the others.
    std::array<std::pair<double, std::size_t>, branches> ways;
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      std::pair<double, std::size_t> way{distance_to(levels_[level - 1][i], p), i};
      if (way.first >= least) continue;
      std::size_t to = count++;
      for (; to > 0 && way < ways[to - 1]; --to) ways[to] = ways[to - 1];
      ways[to] = way;
    }
    for (std::size_t i = 0; i < count && ways[i].first < least; ++i)
      visit(level - 1, ways[i].second, p, least);
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;      // numbers of triangles, neighbours together
  std::vector<std::vector<Box>> levels_;  // last one box that holds all
};

}  // namespace voxweld::testing
