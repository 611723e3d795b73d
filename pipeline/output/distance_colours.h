// Pictures of how far one mesh is from another.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "pipeline/output/render.h"

namespace voxweld {

// Of all samples of a picture, in the unit of the mesh.
struct ShownDistances {
  double mean = 0, p99 = 0, most = 0;  // p99: 99 % of samples are no farther
  double end = 0;                      // where colours end
};

// A mesh to measure from, in memory: about 30 bytes a triangle.
class ReferenceMesh {
 public:
  // path: an output directory, of which the mesh itself is taken, or a file; in the same frame and unit
  // as what is drawn. drawn: the bounds of that. Distances are to a step of 2^-22 of what both take up.
  // Throws what for_each_mesh throws; InputError for a mesh without triangles.
  ReferenceMesh(const std::filesystem::path& path, const MeshBounds& drawn);
  ~ReferenceMesh();

  // Colours what was drawn by its distance: dark purple for none, yellow for `end` and more, or else for
  // what 99 % of samples have. Precondition: RenderOptions::places.
  ShownDistances colour(Renderer& renderer, std::optional<double> end) const;

 private:
  struct Lattice;
  std::unique_ptr<Lattice> lattice_;
};

}  // namespace voxweld
