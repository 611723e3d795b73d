#include "pipeline/output/export.h"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <sstream>
#include <string_view>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

// Points of float, as in the decoded files.
using ExportMesh = OpenMesh::TriMesh_ArrayKernelT<>;

OpenMesh::VertexHandle add_vertex(ExportMesh& out, const DecodedMesh& mesh, std::size_t i) {
  const auto& p = mesh.positions[i];
  const auto v = out.add_vertex({p[0], p[1], p[2]});
  if (!mesh.normals.empty())
    out.set_normal(v, {mesh.normals[i][0], mesh.normals[i][1], mesh.normals[i][2]});
  return v;
}

// Three vertices of its own for each triangle: OpenMesh's structure refuses triangles that meet in
// a complex edge, and an export must not lose any.
void add_apart(ExportMesh& out, const DecodedMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const auto a = add_vertex(out, mesh, t[0]);
  const auto b = add_vertex(out, mesh, t[1]);
  const auto c = add_vertex(out, mesh, t[2]);
  out.add_face(a, b, c);
}

ExportMesh build(const DecodedMesh& mesh) {
  omerr().disable();  // each refused face, each file written: on stderr and stdout
  omlog().disable();
  ExportMesh out;
  if (!mesh.normals.empty()) out.request_vertex_normals();
  out.reserve(mesh.positions.size(), 3 * mesh.triangles.size() / 2, mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) add_vertex(out, mesh, i);
  for (const auto& t : mesh.triangles) {
    const auto handle = [](std::uint32_t v) { return OpenMesh::VertexHandle(static_cast<int>(v)); };
    if (!out.add_face(handle(t[0]), handle(t[1]), handle(t[2])).is_valid()) add_apart(out, mesh, t);
  }
  return out;
}

}  // namespace

void check_export_name(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 4> known{".ply", ".obj", ".stl", ".off"};
  for (const std::string_view extension : known)
    if (path.extension() == extension) return;
  throw InputError(fmt::format("{}: cannot export to \"{}\", expected .ply, .obj, .stl or .off",
                               path.string(), path.extension().string()));
}

std::string exported_mesh(const DecodedMesh& mesh, const std::filesystem::path& path) {
  check_export_name(path);
  const std::string extension = path.extension().string();
  const ExportMesh built = build(mesh);
  OpenMesh::IO::Options options;
  if (extension == ".ply" || extension == ".stl") options += OpenMesh::IO::Options::Binary;
  if (!mesh.normals.empty() && extension != ".stl") options += OpenMesh::IO::Options::VertexNormal;
  std::ostringstream text;
  const int digits = std::numeric_limits<float>::max_digits10;
  if (!OpenMesh::IO::write_mesh(built, text, extension, options, digits))
    throw StorageError(fmt::format("cannot write {}: OpenMesh refused the mesh", path.string()));
  return std::move(text).str();
}

void write_exported(const std::filesystem::path& path, const std::string& text,
                    const InterruptFlag* interrupt) {
  constexpr std::size_t piece = std::size_t{4} << 20;
  AtomicFile file(path);
  for (std::span<const std::byte> left = as_bytes(text); !left.empty();) {
    if (interrupt != nullptr) interrupt->check();
    file.append(left.first(std::min(left.size(), piece)));
    left = left.subspan(std::min(left.size(), piece));
  }
  if (interrupt != nullptr) interrupt->check();
  file.commit(Durability::fsync);
}

}  // namespace voxweld
