// Based on: Turk, "The PLY Polygon File Format" (1994); Wavefront's "Object Files" (1995); the binary
// STL of 3D Systems' "StereoLithography Interface Specification" (1988).
#include "stages/encode/mesh_streams.h"

#include <fmt/format.h>

#include <cmath>

#include "stages/encode/corner_points.h"
#include "stages/encode/stream_out.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

struct LabelText {
  bool ints = true;  // 32 bits hold them
  void put(StreamOut& out, Material label) const {
    if (ints)
      out.put(label == exterior ? std::int32_t{-1} : static_cast<std::int32_t>(label));
    else
      out.put(label == exterior ? -1.0 : static_cast<double>(label));
  }
};

void check_ply(const StreamTotals& totals) {
  if (totals.vertices > std::numeric_limits<std::uint32_t>::max())
    throw InputError(
        fmt::format("a .ply file numbers its vertices in 32 bits, the mesh has {}: use the tiles",
                    totals.vertices));
  if (totals.highest_label > std::uint64_t{1} << 53)
    throw InputError(
        fmt::format("a .ply file holds labels up to 2^53, the mesh has label {}: leave \"ply\" out "
                    "of output.formats",
                    totals.highest_label));
}

LabelText put_ply_header(StreamOut& out, const StreamTotals& totals) {
  const LabelText labels{totals.highest_label <= std::numeric_limits<std::int32_t>::max()};
  // Some readers know signed numbers alone.
  const bool few = totals.vertices <= std::numeric_limits<std::int32_t>::max();
  out.text("ply\nformat binary_little_endian 1.0\ncomment voxweld " VOXWELD_VERSION "\n");
  out.text("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
           totals.vertices);
  if (totals.normals && !totals.between_labels)
    out.text("property float nx\nproperty float ny\nproperty float nz\n");
  out.text("element face {}\nproperty list uchar {} vertex_indices\n", totals.triangles,
           few ? "int" : "uint");
  if (totals.between_labels)
    out.text("property {0} label\nproperty {0} label_outside\n", labels.ints ? "int" : "double");
  out.text("end_header\n");
  return labels;
}

class MeshSinkInMemory final : public MeshSink {
 public:
  explicit MeshSinkInMemory(const std::string& where) : where_(where) {}

  void vertex(Vec3 place) override { mesh.positions.push_back(as_floats(place)); }
  void triangle(const std::array<std::uint64_t, 3>& corners) override {
    if (corners[0] > most || corners[1] > most || corners[2] > most)
      throw FormatError(where_ + ": more vertices than 32 bits count");
    mesh.triangles.push_back({static_cast<std::uint32_t>(corners[0]),
                              static_cast<std::uint32_t>(corners[1]),
                              static_cast<std::uint32_t>(corners[2])});
  }
  void facet(const std::array<Vec3, 3>& corners) override {
    const std::uint64_t first = mesh.positions.size();
    for (const Vec3& corner : corners) vertex(corner);
    triangle({first, first + 1, first + 2});
  }
  void labels(double inside, double outside) override {
    const MaterialPair pair{material(inside), material(outside)};
    if (mesh.pairs.empty() || mesh.pairs.back() != pair) mesh.pairs.push_back(pair);
    mesh.triangle_pairs.resize(mesh.triangles.size(),
                               static_cast<std::uint32_t>(mesh.pairs.size() - 1));
  }

  DecodedMesh mesh;

 private:
  static constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  Material material(double value) const {
    if (value == -1) return exterior;
    if (!(value >= 0 && value <= 9007199254740992.0 && value == std::floor(value)))
      throw FormatError(fmt::format("{}: a face has label {}", where_, value));
    return static_cast<Material>(value);
  }
  const std::string& where_;
};

}  // namespace

StreamTotals totals_of(const EachTile& each_tile) {
  StreamTotals totals;
  TileWelder welder;
  each_tile([&](const TileMesh& tile) {
    welder.add(tile);
    totals.normals |= !tile.corner_normals.empty();
    totals.between_labels |= !tile.pairs.empty();
    for (const MaterialPair& pair : tile.pairs)
      for (const Material label : {pair.inside, pair.outside})
        if (label != exterior) totals.highest_label = std::max(totals.highest_label, label);
  });
  totals.vertices = welder.vertices();
  totals.triangles = welder.triangles();
  return totals;
}

void stream_ply(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink) {
  check_ply(totals);
  StreamOut out(sink);
  const LabelText labels = put_ply_header(out, totals);
  TileWelder vertices;
  each_tile([&](const TileMesh& tile) {
    vertices.add(tile);
    for (const std::uint32_t v : vertices.fresh()) {
      out.put(float_position(tile.lattice, tile.positions[v]));
      if (totals.normals && !totals.between_labels) out.put(mean_direction(tile.normals[v]));
    }
  });
  TileWelder faces;  // numbers them once more
  each_tile([&](const TileMesh& tile) {
    faces.add(tile);
    for (std::size_t t = 0; t < tile.triangles.size(); ++t) {
      out.put(std::uint8_t{3});
      for (const std::uint32_t v : tile.triangles[t])
        out.put(static_cast<std::uint32_t>(faces.numbers()[v]));
      if (!totals.between_labels) continue;
      const MaterialPair& pair = tile.pairs[tile.triangle_pairs[t]];
      labels.put(out, pair.inside);
      labels.put(out, pair.outside);
    }
  });
  out.flush();
}

void stream_stl(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink) {
  if (totals.triangles > std::numeric_limits<std::uint32_t>::max())
    throw InputError(
        fmt::format("an .stl file counts its triangles in 32 bits, the mesh has {}: use the tiles",
                    totals.triangles));
  StreamOut out(sink);
  std::array<char, 80> title{};
  constexpr std::string_view name = "binary STL of voxweld " VOXWELD_VERSION;
  static_assert(name.size() < title.size());
  std::ranges::copy(name, title.begin());
  out.put(title);
  out.put(static_cast<std::uint32_t>(totals.triangles));
  each_tile([&](const TileMesh& tile) {
    for (const auto& t : tile.triangles) {
      std::array<Vec3, 3> at{};
      for (std::size_t k = 0; k < 3; ++k)
        for (int a = 0; a < 3; ++a)
          at[k][a] = tile.lattice.coordinate(a, tile.positions[t[k]][static_cast<std::size_t>(a)]);
      const Vec3 across = cross(at[1] - at[0], at[2] - at[0]);
      const double length = std::sqrt(dot(across, across));
      out.put(length > 0 ? as_floats(across * (1 / length)) : Floats{});
      for (const Vec3& corner : at) out.put(as_floats(corner));
      out.put(std::uint16_t{0});
    }
  });
  out.flush();
}

void stream_obj(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink) {
  StreamOut out(sink);
  out.text("# voxweld " VOXWELD_VERSION "\n");
  TileWelder welder;
  std::uint64_t normals = 0;
  std::vector<std::pair<std::uint32_t, CornerNormal>> points;
  each_tile([&](const TileMesh& tile) {
    welder.add(tile);
    for (const std::uint32_t v : welder.fresh()) {
      const Floats p = float_position(tile.lattice, tile.positions[v]);
      out.text("v {} {} {}\n", p[0], p[1], p[2]);
    }
    const auto numbers = welder.numbers();
    if (!totals.normals) {
      for (const auto& t : tile.triangles)
        out.text("f {} {} {}\n", numbers[t[0]] + 1, numbers[t[1]] + 1, numbers[t[2]] + 1);
      return;
    }
    const CornerPoints corners(tile);
    points.resize(corners.count());
    corners.each([&](std::uint32_t point, std::uint32_t vertex, CornerNormal normal) {
      points[point] = {vertex, normal};
    });
    for (const auto& [vertex, normal] : points) {
      const Vec3 n = normal.of(tile.normals[vertex]);
      out.text("vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    }
    for (std::size_t t = 0; t < tile.triangles.size(); ++t) {
      const auto number = [&](std::size_t k) { return numbers[tile.triangles[t][k]] + 1; };
      const auto normal = [&](std::size_t k) {
        return normals + corners.of(tile.triangles[t][k], tile.corner_normals[t][k]) + 1;
      };
      out.text("f {}//{} {}//{} {}//{}\n", number(0), normal(0), number(1), normal(1), number(2),
               normal(2));
    }
    normals += corners.count();
  });
  out.flush();
}

std::uint64_t stream_bytes(std::uint64_t vertices) {
  // Numbers, turns and fresh places of a welder; points by vertex and normal, and their list, which is
  // as long as a vertex has normals; the next bytes.
  constexpr std::uint64_t welder = 8 + 8 + 2 * 4, points = CornerNormal::values * 4 + 6 * 8;
  return vertices * (welder + points) + (std::uint64_t{1} << 20);
}

DecodedMesh decode_mesh_file(std::span<const std::byte> file, const std::string& format,
                             const std::string& where) {
  MeshSinkInMemory sink(where);
  read_mesh_bytes(file, format, where, sink);
  if (!sink.mesh.triangle_pairs.empty() &&
      sink.mesh.triangle_pairs.size() != sink.mesh.triangles.size())
    throw FormatError(where + ": only some of its faces have labels");
  return std::move(sink.mesh);
}

}  // namespace voxweld
