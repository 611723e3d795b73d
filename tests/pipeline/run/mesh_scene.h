// Meshes that go in as solids, and what is measured of those that come out.
#pragma once

#include <filesystem>
#include <string>

#include "storage/types/triangle_mesh.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {

void write_off(const std::filesystem::path& path, const TriangleMesh& mesh);

// A file of meshes that are no part of the project; empty where there is none of that name.
std::filesystem::path shared_mesh(const std::string& name);

// Of a mesh file, with vertices of several normals put together again, moved.
TriangleMesh welded_mesh(const std::filesystem::path& path, Vec3 by = {});

struct Spread {
  double sum = 0, most = 0;
  std::size_t count = 0, near = 0;
  void add(double value, double limit) {
    sum += value;
    most = std::max(most, value);
    ++count;
    near += value <= limit ? 1 : 0;
  }
  double mean() const { return sum / static_cast<double>(count); }
  double share() const { return static_cast<double>(near) / static_cast<double>(count); }
};

// Of points from a mesh, in cells; the near ones are within a tenth of one.
Spread distances(const std::vector<Vec3>& points, const TriangleMesh& mesh, double cell);

// Points of edges, half a cell apart. edges: as sharp_edges() gives them.
std::vector<Vec3> points_on(const TriangleMesh& edges, double cell);

// A config whose input is a mesh: `input` are further lines of [input], `more` lines behind it.
class MeshInputScene {
 public:
  MeshInputScene();
  void set(const std::filesystem::path& mesh, const std::string& input,
           const std::string& more = {}) const;
  const Scene& scene() const { return scene_; }
  std::filesystem::path at(const std::string& name) const { return scene_.directory() / name; }
  // The mesh that comes out of a run.
  TriangleMesh result(const Settings& settings = {}) const;
  std::string bytes(const Settings& settings = {}) const;  // its hash

 private:
  Scene scene_;
};

}  // namespace voxweld::testing
