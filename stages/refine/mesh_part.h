// Parts of a mesh, and meshes put together from parts.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>

#include "stages/refine/cube_lattice.h"
#include "storage/types/index_table.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// The samples of triangles, quickest where triangles are asked for in nearly their order.
class SampleReader {
 public:
  explicit SampleReader(const RefineMesh& mesh) : samples_(&mesh.samples) {}
  // f(sample) for each of a triangle's samples.
  template <class F>
  void each(std::uint32_t triangle, F&& f) {
    const std::vector<SurfaceSample>& samples = *samples_;
    if (!is_first(triangle))
      at_ = static_cast<std::size_t>(
          std::lower_bound(samples.begin(), samples.end(), triangle,
                           [](const SurfaceSample& a, std::uint32_t t) { return a.triangle < t; }) -
          samples.begin());
    for (; at_ < samples.size() && samples[at_].triangle == triangle; ++at_) f(samples[at_]);
  }

 private:
  // Whether the triangle's samples begin here, or would.
  bool is_first(std::uint32_t triangle) const {
    return (at_ == 0 || (*samples_)[at_ - 1].triangle < triangle) &&
           (at_ == samples_->size() || (*samples_)[at_].triangle >= triangle);
  }
  const std::vector<SurfaceSample>* samples_;
  std::size_t at_ = 0;
};

// Of some triangles of a mesh a mesh, many times from the same one.
class Extract {
 public:
  explicit Extract(const RefineMesh& from);

  // chosen: ascending. Vertices by first use.
  RefineMesh of(std::span<const std::uint32_t> chosen);

 private:
  std::uint32_t number(std::uint32_t v, RefineMesh& part, std::vector<std::uint32_t>& used);

  const RefineMesh& from_;
  std::vector<std::uint32_t> number_;
};

// Of parts one mesh: vertices with the same id are one. Triangles as they come, vertices by first
// use. It is checked where all parts are.
class MeshGather {
 public:
  MeshGather() = default;
  MeshGather(const MeshGather&) = delete;  // the table refers to the mesh
  MeshGather& operator=(const MeshGather&) = delete;

  // A mesh to take triangles from. Its vertices are looked up once each. The mesh outlives it.
  class Part {
   public:
    explicit Part(const RefineMesh& mesh)
        : mesh_(&mesh), samples_(mesh), numbers_(mesh.positions.size(), VertexTable::none) {}
    const RefineMesh& mesh() const { return *mesh_; }

   private:
    friend class MeshGather;
    const RefineMesh* mesh_;
    SampleReader samples_;
    std::vector<std::uint32_t> numbers_;  // in what is put together
  };

  // Makes room for so many, so that gather_bytes() is enough. shared: the vertices of all parts but
  // those of add_last(), where that is known.
  void reserve(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
               std::uint64_t sided = 0, std::optional<std::uint64_t> shared = {});
  void add(const RefineMesh& part);
  // The same, quicker. Precondition: no part that is added after this one has any of the vertices that
  // come with it.
  void add_last(const RefineMesh& part);
  // The triangles of the part for which takes(number) holds.
  void add(const RefineMesh& part, const std::function<bool(std::size_t)>& takes);
  // Those with these numbers.
  void add(const RefineMesh& part, const std::vector<std::uint32_t>& triangles);
  // One triangle; with Part where there are many. Precondition: nothing was taken out since the first
  // one of this Part.
  void add_triangle(const RefineMesh& part, std::uint32_t triangle, bool intersects);
  void add_triangle(Part& part, std::uint32_t triangle, bool intersects);
  const RefineMesh& mesh() const { return mesh_; }
  RefineMesh take();

 private:
  // Its number here. keeps: whether other parts may have it, too.
  std::uint32_t number(const RefineMesh& part, std::uint32_t v, bool keeps = true);
  void begin(const RefineMesh& part);
  void add_all(const RefineMesh& part, bool keeps);
  void add_corners(Part& part, std::array<std::uint32_t, 3> corners, bool keeps = true);

  RefineMesh mesh_;
  VertexTable numbers_{VertexIdHash{&mesh_.ids}};
};

// Takes out the triangles with all corners in one of these boxes, which do not meet. Vertices stay.
void remove_inside(RefineMesh& mesh, const std::vector<LatticeBox>& boxes);

// Bytes of a mesh in memory. sided: how many of the triangles have sides.
std::uint64_t mesh_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
                         std::uint64_t sided = 0);
// Bytes a MeshGather takes at most that has made room for a mesh of that size, parts not counted.
std::uint64_t gather_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
                           std::uint64_t sided = 0);

// What is at home in one cube: triangles with all corners in it, and those that leave it.
struct CubePiece {
  Index3 cube;
  std::uint64_t code = 0;
  RefineMesh inside, leaving;
};

// f of each cube that has triangles at home, ascending by code and then by the cube's Morton number;
// triangles in the order of the mesh.
void each_piece(const RefineMesh& mesh, const CubeLattice& cubes,
                const std::function<void(const CubePiece&)>& f);

// Bytes each_piece takes at most, beside its argument.
std::uint64_t piece_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t sided = 0);

}  // namespace voxweld
