// Meshes that go in as solids, and those that come out.
#pragma once

#include <filesystem>
#include <string>

#include "storage/types/triangle_mesh.h"
#include "tests/pipeline/run/scene.h"
#include "tests/support/mesh_fidelity.h"

namespace voxweld::testing {

void write_off(const std::filesystem::path& path, const TriangleMesh& mesh);

// A file of meshes that are no part of the project; empty where there is none of that name.
std::filesystem::path shared_mesh(const std::string& name);

// Of a mesh file, with vertices of several normals put together again, moved.
TriangleMesh welded_mesh(const std::filesystem::path& path, Vec3 by = {});

// A config whose input is a mesh, without refine: `input` are further lines of [input], `more` lines behind it.
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
