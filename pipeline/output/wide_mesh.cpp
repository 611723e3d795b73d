#include "pipeline/output/wide_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>

#include "pipeline/output/export.h"
#include "pipeline/output/load.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// The manifest of the output directory a file lies in: beside it, or above tiles/ and labels/.
fs::path manifest_near(const fs::path& file) {
  fs::path folder = fs::absolute(file).parent_path();
  for (int level = 0; level < 4 && folder.has_relative_path(); ++level) {
    if (fs::exists(folder / manifest_name)) return folder / manifest_name;
    folder = folder.parent_path();
  }
  throw InputError(fmt::format(
      "{}: --world needs the {} of the output directory that the file was written to, which says "
      "where the volume lies; it is neither beside the file nor above it. Name the file there, or "
      "leave --world out",
      file.string(), manifest_name));
}

// Positions of one label are one vertex where their bits are the same.
class Collector {
 public:
  explicit Collector(const ExportOptions& options) : weld_(options.weld), level_(options.level) {}

  void add(const DecodedMesh& mesh, std::optional<Material> label) {
    if (mesh_.positions.size() + mesh.positions.size() > std::numeric_limits<std::uint32_t>::max())
      throw InputError("the mesh has more vertices than one file can count; export its tiles");
    // Of the mesh itself a label's tiles come together.
    if (label != label_ && level_ == 0) known_.clear();
    label_ = label;
    std::vector<std::uint32_t> becomes;
    becomes.reserve(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) becomes.push_back(add(mesh, i));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      mesh_.triangles.push_back({becomes[a], becomes[b], becomes[c]});
      if (label) mesh_.labels.push_back(*label);
      if (mesh.triangle_pairs.empty()) continue;
      const MaterialPair& pair = mesh.pairs[mesh.triangle_pairs[i]];
      mesh_.labels.push_back(pair.inside);
      mesh_.labels_outside.push_back(pair.outside);
    }
  }

  WideMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t add(const DecodedMesh& mesh, std::size_t i) {
    const auto& p = mesh.positions[i];
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    if (weld_) {
      const auto [at, fresh] = known_[label_].try_emplace(p, next);
      if (!fresh) return at->second;
    } else if (!mesh.normals.empty()) {
      mesh_.normals.push_back(mesh.normals[i]);
    }
    mesh_.positions.push_back(
        {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    return next;
  }

  struct Hash {
    std::size_t operator()(const std::array<float, 3>& p) const {
      std::uint64_t hash = 0;
      for (const float x : p) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &x, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15U;
        hash ^= hash >> 29;
      }
      return static_cast<std::size_t>(hash);
    }
  };

  using Numbers = std::unordered_map<std::array<float, 3>, std::uint32_t, Hash>;

  bool weld_;
  int level_;  // of detail
  WideMesh mesh_;
  std::optional<Material> label_;
  std::map<std::optional<Material>, Numbers> known_;
};

void into_world(const VolumeGeometry& frame, WideMesh& mesh) {
  const auto& [x, y, z] = frame.direction;
  for (Vec3& p : mesh.positions) p = frame.origin + x * p.x + y * p.y + z * p.z;
  mesh.doubles = true;
  // Normals go by the cofactors; where the world is mirrored, triangles are turned around, so that
  // both still point outward.
  const Vec3 of_x = cross(y, z), of_y = cross(z, x), of_z = cross(x, y);
  const double turn = dot(x, of_x) < 0 ? -1 : 1;
  for (auto& normal : mesh.normals) {
    const Vec3 n = (of_x * static_cast<double>(normal[0]) + of_y * static_cast<double>(normal[1]) +
                    of_z * static_cast<double>(normal[2])) *
                   turn;
    const double length = std::sqrt(dot(n, n));
    for (int a = 0; a < 3; ++a)
      normal[static_cast<std::size_t>(a)] = static_cast<float>(length > 0 ? n[a] / length : n[a]);
  }
  if (turn < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  mesh.comment = fmt::format("world coordinates{}{}", frame.space.empty() ? "" : ", " + frame.space,
                             frame.unit.empty() ? "" : ", in " + frame.unit);
}

// All of it is written in the machine's order, which is little-endian.
template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void put_floats(std::string& out, Vec3 v) {
  for (int a = 0; a < 3; ++a) put(out, static_cast<float>(v[a]));
}

// PLY has no integers of 64 bits; doubles hold those of labels that 32 bits do not.
bool fits_int(const std::vector<Material>& labels) {
  return std::ranges::all_of(labels, [](Material label) {
    return label == exterior ||
           label <= static_cast<Material>(std::numeric_limits<std::int32_t>::max());
  });
}

void put_label(std::string& out, Material label, bool ints) {
  if (ints)
    put(out, label == exterior ? std::int32_t{-1} : static_cast<std::int32_t>(label));
  else
    put(out, label == exterior ? -1.0 : static_cast<double>(label));
}

std::string ply(const WideMesh& mesh) {
  const char* const real = mesh.doubles ? "double" : "float";
  const bool ints = fits_int(mesh.labels) && fits_int(mesh.labels_outside);
  const char* const integer = ints ? "int" : "double";
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  if (!mesh.comment.empty()) out += fmt::format("comment {}\n", mesh.comment);
  out += fmt::format("element vertex {0}\nproperty {1} x\nproperty {1} y\nproperty {1} z\n",
                     mesh.positions.size(), real);
  if (!mesh.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\n",
                     mesh.triangles.size());
  if (!mesh.labels.empty()) out += fmt::format("property {} label\n", integer);
  if (!mesh.labels_outside.empty()) out += fmt::format("property {} label_outside\n", integer);
  out += "end_header\n";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.doubles)
      for (int a = 0; a < 3; ++a) put(out, mesh.positions[i][a]);
    else
      put_floats(out, mesh.positions[i]);
    if (!mesh.normals.empty())
      for (const float x : mesh.normals[i]) put(out, x);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    put(out, std::uint8_t{3});
    for (const std::uint32_t corner : mesh.triangles[i]) put(out, corner);
    if (!mesh.labels.empty()) put_label(out, mesh.labels[i], ints);
    if (!mesh.labels_outside.empty()) put_label(out, mesh.labels_outside[i], ints);
  }
  return out;
}

// The shortest text that is read back as the same number.
std::string text_of(const WideMesh& mesh, Vec3 p) {
  if (mesh.doubles) return fmt::format("{} {} {}", p.x, p.y, p.z);
  return fmt::format("{} {} {}", static_cast<float>(p.x), static_cast<float>(p.y),
                     static_cast<float>(p.z));
}

std::string obj(const WideMesh& mesh) {
  std::string out;
  if (!mesh.comment.empty()) out += fmt::format("# {}\n", mesh.comment);
  for (const Vec3& p : mesh.positions) out += "v " + text_of(mesh, p) + "\n";
  for (const auto& n : mesh.normals) out += fmt::format("vn {} {} {}\n", n[0], n[1], n[2]);
  for (const auto& t : mesh.triangles) {
    out += "f";
    for (const std::uint32_t corner : t)
      out += mesh.normals.empty() ? fmt::format(" {}", corner + 1)
                                  : fmt::format(" {0}//{0}", corner + 1);
    out += "\n";
  }
  return out;
}

std::string off(const WideMesh& mesh) {
  const bool normals = !mesh.normals.empty();
  std::string out = normals ? "NOFF\n" : "OFF\n";
  out += fmt::format("{} {} 0\n", mesh.positions.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    out += text_of(mesh, mesh.positions[i]);
    if (normals)
      out += fmt::format(" {} {} {}", mesh.normals[i][0], mesh.normals[i][1], mesh.normals[i][2]);
    out += "\n";
  }
  for (const auto& [a, b, c] : mesh.triangles) out += fmt::format("3 {} {} {}\n", a, b, c);
  return out;
}

std::string stl(const WideMesh& mesh) {
  std::string out(80, ' ');
  out.replace(0, 15, "binary stl file");
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3 n = cross(b - a, c - a);
    const double length = std::sqrt(dot(n, n));
    put_floats(out, length > 0 ? n * (1 / length) : n);
    for (const Vec3& corner : {a, b, c}) put_floats(out, corner);
    put(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace

WideMesh load_wide_mesh(const fs::path& path, const ExportOptions& options, MeshWriters formats) {
  Collector collector(options);
  for_each_mesh(
      path,
      [&](const DecodedMesh& mesh, std::optional<Material> label) { collector.add(mesh, label); },
      formats, options.level);
  WideMesh mesh = collector.take();
  if (!options.world) return mesh;
  const fs::path manifest = fs::is_directory(path) ? path / manifest_name : manifest_near(path);
  into_world(read_manifest(manifest).frame, mesh);
  return mesh;
}

std::string exported_wide_mesh(const WideMesh& mesh, const fs::path& path) {
  check_export_name(path);
  const std::string extension = path.extension().string();
  return extension == ".ply"   ? ply(mesh)
         : extension == ".obj" ? obj(mesh)
         : extension == ".off" ? off(mesh)
                               : stl(mesh);
}

}  // namespace voxweld
