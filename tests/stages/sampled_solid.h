// Meshes on a lattice, asked for the sides of all samples and all crossings.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "stages/solids/mesh_solid.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {

// By number in the box, x the fastest.
using Sides = std::vector<char>;

inline std::size_t index_in(const Box3& box, Index3 at) {
  const Index3 size = box.size(), d = at - box.lo;
  return static_cast<std::size_t>((d.z * size.y + d.y) * size.x + d.x);
}

// The sides of all samples of the box, by each_flip.
inline Sides sides_of(const LatticeSolid& solid, const Box3& box) {
  Sides inside(static_cast<std::size_t>(box.count()));
  solid.each_flip(box, [&](const LatticeSolid::Flip& flip) {
    for (std::int64_t x = flip.x; x < box.hi.x; ++x)
      inside[index_in(box, {x, flip.y, flip.z})] ^= 1;
  });
  return inside;
}

inline Box3 random_box(Index3 size, std::mt19937& random) {
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(size[a] - 1));
    box.hi[a] =
        box.lo[a] + 1 +
        static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(size[a] - box.lo[a]));
  }
  return box;
}

template <class Mesh>
struct Sampled {
  VolumeFrame frame;
  Mesh mesh;
  Sides inside;

  Sampled(const TriangleMesh& triangles, const VolumeFrame& f)
      : frame(f), mesh(triangles, f, {}), inside(sides_of(mesh, {{}, f.size})) {}
  bool at(Index3 s) const { return inside[index_in({{}, frame.size}, s)] != 0; }
  template <class F>
  void each_sample(F&& f) const {
    each_index(frame.size, f);
  }
  // f(axis, low end, crossing) of each edge with a side change.
  template <class F>
  void each_crossing(F&& f) const {
    each_sample([&](Index3 s) {
      for (int axis = 0; axis < 3; ++axis) {
        Index3 high = s;
        if (++high[axis] < frame.size[axis] && at(s) != at(high))
          f(axis, s, mesh.crossing(axis, s, at(s)));
      }
    });
  }
  // A part of the samples has the sides that it has in the whole.
  void expect_sides_of_boxes(std::mt19937& random) const {
    for (int round = 0; round < 50; ++round) {
      const Box3 box = random_box(frame.size, random);
      const Sides part = sides_of(mesh, box);
      each_index(box, [&](Index3 s) { EXPECT_EQ(part[index_in(box, s)] != 0, at(s)); });
    }
  }
};

inline double nearest(const TriangleMesh& mesh, Vec3 p) {
  double least = 1e300;
  for (const auto& t : mesh.triangles)
    least =
        std::min(least, distance(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return least;
}

}  // namespace voxweld::testing
