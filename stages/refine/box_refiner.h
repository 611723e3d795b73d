// Refines boxes of a mesh, and puts together what comes of them.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "stages/refine/mesh_part.h"
#include "stages/refine/nearest_triangle.h"
#include "stages/refine/refine_range.h"

namespace voxweld {

using TriangleNumbers = std::vector<std::uint32_t>;

// Whether all corners do.
bool lies_in(const RefineMesh& mesh, std::size_t triangle, const LatticeBox& box);

// Where something is done, and the box that is cut up if that is too much: larger where the volume
// ends in it. So where a cube is cut does not depend on the volume, and cubes of two passes that hold
// the same part of a small one are not cut in the same places.
struct Room {
  LatticeBox box, whole;
};

// f(part, triangles) for the box, or for its parts where it is cut up because more triangles meet it
// than memory should hold; with those of `meeting` that meet each. left(triangle) for what lies in the
// box, but in no part.
void each_part(const RefineMesh& mesh, const Room& room, const TriangleNumbers& meeting,
               const std::function<void(const LatticeBox&, const TriangleNumbers&)>& f,
               const std::function<void(std::uint32_t)>& left);

class BoxRefiner {
 public:
  // All three outlive it.
  BoxRefiner(const RefineMesh& mesh, const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh), parameters_(parameters), counts_(counts), extract_(mesh), as_it_was_(mesh) {}

  // For what comes out.
  void reserve(const MeshSize& size) {
    out_.reserve(size.vertices, size.triangles, size.samples, size.sided);
  }

  struct Work {
    const Room& room;
    const TriangleNumbers& meeting;  // all triangles that meet it
    const TriangleNumbers& others;   // that come out too, as they are
    const TriangleNumbers& bad;  // ascending: of those that are fixed here the ones that intersect
  };
  // Triangles come out by their ids.
  void refine(const Work& work);
  RefineMesh take();

  // What is to come out of a box.
  class Outcome;
  // refine() in two steps: the first one may be taken for several boxes at the same time, each with
  // Extracts of `mesh` of its own, and the second one in the order in which they are to come out. Of a box
  // that is cut up as many parts are done at the same time as there are Extracts, and as have no more
  // triangles than parameters say.
  Outcome work_on(const Work& work, std::span<Extract> extracts) const;
  // Of a box in which nothing may change. bad: as of Work.
  Outcome kept(const TriangleNumbers& triangles, const TriangleNumbers& bad) const;
  void put_out(const Outcome& outcome);

 private:
  struct Part;
  bool stays(const TriangleNumbers& triangles) const;
  void work_on_part(Part& part, Extract& extract) const;

  const RefineMesh& mesh_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  Extract extract_;
  MeshGather::Part as_it_was_;
  MeshGather out_;
};

class BoxRefiner::Outcome {
 private:
  friend class BoxRefiner;
  explicit Outcome(const RefineMesh& mesh) : mesh_(&mesh) {}

  // One triangle that comes out.
  struct Done {
    std::uint32_t mesh : 31;  // 0: as it was, else of refined_, from 1 on
    std::uint32_t intersects : 1;
    std::uint32_t triangle;
    VertexId first;  // of its corners, which mostly tells the order
  };
  const RefineMesh& mesh_of(const Done& done) const {
    return done.mesh == 0 ? *mesh_ : *refined_[done.mesh - 1];
  }
  void add(std::size_t mesh, std::uint32_t triangle, bool intersects);
  void add(Part&& part);
  // Triangles of the mesh as they are. bad: as of Work.
  void keep(std::uint32_t triangle, const TriangleNumbers& bad) {
    add(0, triangle, std::binary_search(bad.begin(), bad.end(), triangle));
  }
  // The mesh of a part, refined, which takes the place of what lies in the box.
  void add_refined(std::unique_ptr<RefineMesh> part, const LatticeBox& box);
  // Puts triangles in order, and counts their samples' distances where that is asked for.
  void finish(bool counts_distances);

  const RefineMesh* mesh_;
  std::vector<std::unique_ptr<RefineMesh>> refined_;
  std::vector<Done> done_;
  RefineCounts counts_;
};

// f(distance) for each of a triangle's samples, from it.
template <class F>
void each_sample_distance(const RefineMesh& mesh, SampleReader& samples, std::uint32_t triangle,
                          F&& f) {
  const MeasuredTriangle shape(mesh.shape(triangle));
  samples.each(triangle, [&](const SurfaceSample& sample) {
    f(std::sqrt(shape.squared_distance(sample.point)));
  });
}

}  // namespace voxweld
