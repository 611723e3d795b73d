#include "tests/pipeline/solids/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

namespace voxweld::testing {
namespace {

template <class T>
void put(std::string& out, T value, bool big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

std::string ply(const TriangleMesh& mesh, const std::string& encoding) {
  std::string out = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      encoding, mesh.vertices.size(), mesh.triangles.size());
  const bool text = encoding == "ascii", big = encoding == "binary_big_endian";
  for (const Vec3& v : mesh.vertices) {
    if (text) out += fmt::format("{} {} {}\n", v.x, v.y, v.z);
    for (int a = 0; !text && a < 3; ++a) put(out, v[a], big);
  }
  for (const auto& t : mesh.triangles) {
    if (text) out += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    if (text) continue;
    out += '\3';
    for (const std::uint32_t corner : t) put(out, corner, big);
  }
  return out;
}

std::string stl(const TriangleMesh& mesh, bool text) {
  std::string out = text ? "solid x\n" : std::string(80, ' ');
  if (!text) put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    out += text ? "facet normal 0 0 0\nouter loop\n" : std::string(12, '\0');
    for (const std::uint32_t corner : t) {
      const Vec3 v = mesh.vertices[corner];
      if (text) out += fmt::format("vertex {} {} {}\n", float(v.x), float(v.y), float(v.z));
      for (int a = 0; !text && a < 3; ++a) put(out, static_cast<float>(v[a]));
    }
    out += text ? "endloop\nendfacet\n" : std::string(2, '\0');
  }
  return out;
}

std::string off(const TriangleMesh& mesh) {
  std::string out = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) out += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) out += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return out;
}

// Vertices as late as they may come, and every other face counts them from the end.
std::string obj(const TriangleMesh& mesh) {
  std::string out;
  std::size_t there = 0;
  bool from_end = false;
  for (const auto& t : mesh.triangles) {
    for (; there <= *std::ranges::max_element(t); ++there) {
      const Vec3 v = mesh.vertices[there];
      out += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    }
    out += "f";
    for (const std::uint32_t corner : t)
      out += from_end ? fmt::format(" -{}", there - corner) : fmt::format(" {}", corner + 1);
    out += "\n";
    from_end = !from_end;
  }
  return out;
}

}  // namespace

const std::vector<std::string>& mesh_file_names() {
  static const std::vector<std::string> names = {"a.off",   "a.obj",    "text.ply",  "little.ply",
                                                 "big.ply", "text.stl", "binary.stl"};
  return names;
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  const std::string name = path.filename().string();
  std::ofstream out(path, std::ios::binary);
  if (name.ends_with(".off")) out << off(mesh);
  if (name.ends_with(".obj")) out << obj(mesh);
  if (name.ends_with("text.ply")) out << ply(mesh, "ascii");
  if (name.ends_with("little.ply")) out << ply(mesh, "binary_little_endian");
  if (name.ends_with("big.ply")) out << ply(mesh, "binary_big_endian");
  if (name.ends_with(".stl")) out << stl(mesh, name.ends_with("text.stl"));
}

}  // namespace voxweld::testing
