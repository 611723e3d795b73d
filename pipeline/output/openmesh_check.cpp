#include "pipeline/output/openmesh_check.h"

#include <fmt/format.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "stages/encode/adjacency.h"

namespace voxweld {
namespace {

using OpenMesh::VertexHandle;

struct OpenMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3f;
  HalfedgeAttributes(0);  // no stored previous half-edges: saves 24 bytes a triangle
};
using OpenTriMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMeshTraits>;

// Returns the number of triangles OpenMesh refused.
std::uint64_t build(const LatticeMesh& mesh, OpenTriMesh& out) {
  omerr().disable();  // it says so on stderr for each refused face
  out.reserve(mesh.positions.size(), 3 * mesh.triangles.size() / 2, mesh.triangles.size());
  for (const LatticePoint& q : mesh.positions)
    out.add_vertex(
        {static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2])});
  std::uint64_t refused = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto handle = [](std::uint32_t v) { return VertexHandle(static_cast<int>(v)); };
    if (!out.add_face(handle(t[0]), handle(t[1]), handle(t[2])).is_valid()) ++refused;
  }
  return refused;
}

}  // namespace

std::vector<std::string> openmesh_problems(LatticeMesh mesh, bool open_border) {
  if (open_border) split_fans(mesh);
  OpenTriMesh built;
  const std::uint64_t refused = build(mesh, built);
  std::uint64_t not_manifold = 0, boundary = 0, unused = 0;
  for (const auto v : built.vertices()) {
    not_manifold += !built.is_manifold(v);
    unused += built.is_isolated(v);
  }
  for (const auto e : built.edges()) boundary += built.is_boundary(e);
  std::vector<std::string> problems;
  const auto note = [&](std::uint64_t count, const char* what) {
    if (count > 0) problems.push_back(fmt::format("OpenMesh finds {} {}", count, what));
  };
  note(refused, "triangles that make a complex edge or vertex");
  note(not_manifold, "vertices that are not 2-manifold");
  note(unused, "vertices without triangles");
  if (!open_border) note(boundary, "boundary edges");
  return problems;
}

}  // namespace voxweld
