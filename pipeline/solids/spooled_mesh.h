// A mesh file that does not fit memory, read once: its triangles in a scratch file, each by the
// places of its corners.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

#include "stages/solids/solid.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/scratch_file.h"

namespace voxweld {

// What work on such a mesh is given.
struct MeshWork {
  std::filesystem::path folder;  // for scratch files
  std::uint64_t memory = 0;      // bytes that may be taken
  // What is done, and to how many triangles so far.
  using Progress = std::function<void(std::string_view, std::uint64_t)>;
  std::function<void()> between;  // called now and then, to stop; may be empty
  Progress progress = {};         // called as often; may be empty

  void step(std::string_view what, std::uint64_t triangles) const {
    if (between) between();
    if (progress) progress(what, triangles);
  }
};

class SpooledMesh {
 public:
  using Corners = std::array<Vec3, 3>;

  // Disk: 72 bytes a triangle; of formats that number their vertices 24 for each of them and, while
  // it is read, 250 for each triangle more.
  // Throws what read_mesh_file throws; FormatError where there are no triangles.
  SpooledMesh(const std::filesystem::path& path, const MeshWork& work);

  const MeshFacts& file() const { return facts_; }
  std::uint64_t vertices() const { return vertices_; }    // as the file has them
  std::uint64_t triangles() const { return triangles_; }  // with three different corners
  const Bounds& bounds() const { return bounds_; }        // of these
  // Of all vertices, be they of a triangle or not.
  const Bounds& vertex_bounds() const { return vertex_bounds_; }

  // f(corners) of each triangle with three different corners, in the order of the file. Zeros are
  // written one way.
  void each(const std::function<void(const Corners&)>& f,
            const std::function<void()>& between = {}) const;

 private:
  class Reading;

  MeshFacts facts_;
  ScratchFile file_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  Bounds bounds_, vertex_bounds_;
};

}  // namespace voxweld
