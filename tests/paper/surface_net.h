// Surface nets of a binary label volume, relaxed under constraints: a plain implementation to
// compare voxweld's label surfaces with.
//
// Based on: Gibson, "Constrained Elastic Surface Nets: Generating Smooth Surfaces from Binary
// Segmented Data", 1998; Frisken, "SurfaceNets for Multi-Label Segmentations with Preservation of
// Sharp Boundaries", 2022. One vertex a mixed cell, a quad for each pair of neighbouring samples on
// different sides; vertices move towards the mean of those they share an edge with, all at once,
// and stay in a box around their cell's centre. Where it differs: two labels only, so there are no
// junctions; a cell has one vertex even where two sheets cross it.
#pragma once

#include <functional>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld::paper {

class SurfaceNet {
 public:
  // inside(sample index); what lies beyond the samples is outside. Samples are 1 apart.
  SurfaceNet(Index3 size, const std::function<bool(Index3)>& inside);

  struct Relaxation {
    int iterations = 16;
    double factor = 0.5;  // of the way to the mean, an iteration
    double reach = 0.5;   // half the box's side: 0.5 is the cell itself
  };
  void relax(const Relaxation& relaxation);
  // Each vertex to the mean of its cell's crossings, taken in the middle of their edges.
  void to_means_of_midpoints();

  // Quads cut along their shorter diagonal, counter-clockwise seen from outside.
  TriangleMesh mesh() const;

 private:
  void find_quads(Index3 size, const std::function<bool(Index3)>& inside);
  std::uint32_t vertex_of(Index3 cell);

  Index3 cells_;
  std::vector<std::uint32_t> vertex_of_cell_;
  std::vector<Vec3> centres_, vertices_, midpoint_sums_;
  std::vector<std::uint32_t> midpoint_counts_;
  std::vector<std::array<std::uint32_t, 4>> quads_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

}  // namespace voxweld::paper
