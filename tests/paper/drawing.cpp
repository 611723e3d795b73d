#include "tests/paper/drawing.h"

#include <cmath>

#include "storage/image/image_file.h"

namespace voxweld::paper {
namespace {

using Point = std::array<float, 3>;

Vec3 place(const TileMesh& mesh, std::uint32_t vertex) {
  Vec3 p;
  for (int a = 0; a < 3; ++a)
    p[a] = mesh.lattice.coordinate(a, mesh.positions[vertex][static_cast<std::size_t>(a)]);
  return p;
}
Point to_point(Vec3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Vec3 unit(Vec3 v) {
  const double length = std::sqrt(dot(v, v));
  return length > 0 ? v * (1 / length) : Vec3{};
}

// Two triangles in a row that share the first one's closing edge are one quad.
bool one_quad(const TileMesh& mesh, std::size_t first) {
  if (first + 1 >= mesh.triangles.size()) return false;
  const auto &t = mesh.triangles[first], &next = mesh.triangles[first + 1];
  return t[0] == next[0] && t[2] == next[1];
}

class Ribbons {
 public:
  Ribbons(const TileMesh& mesh, double width) : mesh_(mesh), width_(width) {}

  // Along the edge from a to b of the triangle with the third corner c, just above it.
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3 p = place(mesh_, a), q = place(mesh_, b), r = place(mesh_, c);
    const Vec3 face = unit(cross(q - p, r - p)), inward = cross(face, unit(q - p));
    const Vec3 lift = face * (0.25 * width_), in = inward * width_;
    const auto first = static_cast<std::uint32_t>(out_.positions.size());
    for (const Vec3& corner : {p, q, q + in, p + in}) {
      out_.positions.push_back(to_point(corner + lift));
      out_.normals.push_back(to_point(face * -1));  // as if turned from the light
    }
    out_.triangles.push_back({first, first + 1, first + 2});
    out_.triangles.push_back({first, first + 2, first + 3});
  }
  DecodedMesh finish() { return std::move(out_); }

 private:
  const TileMesh& mesh_;
  double width_;
  DecodedMesh out_;
};

}  // namespace

DecodedMesh shaded(const TileMesh& mesh) {
  DecodedMesh out;
  out.pairs = mesh.pairs;
  out.triangle_pairs = mesh.triangle_pairs;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      corners[k] = static_cast<std::uint32_t>(out.positions.size());
      out.positions.push_back(to_point(place(mesh, v)));
      out.normals.push_back(to_point(mesh.corner_normals[i][k].of(mesh.normals[v])));
    }
    out.triangles.push_back(corners);
  }
  return out;
}

DecodedMesh edges_of_polygons(const TileMesh& mesh, double width) {
  Ribbons ribbons(mesh, width);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    ribbons.add(a, b, c);
    ribbons.add(b, c, a);
    if (!one_quad(mesh, i)) {
      ribbons.add(c, a, b);
      continue;
    }
    const auto& [d, e, f] = mesh.triangles[++i];
    ribbons.add(e, f, d);
    ribbons.add(f, d, e);
  }
  return ribbons.finish();
}

void draw(const std::vector<TileMesh>& tiles, const Drawing& drawing,
          const std::filesystem::path& png) {
  std::vector<DecodedMesh> meshes;
  meshes.reserve(tiles.size());
  for (const TileMesh& tile : tiles) meshes.push_back(shaded(tile));
  Renderer renderer(bounds_of(meshes), drawing.options);
  for (const DecodedMesh& mesh : meshes) renderer.draw(mesh);
  for (const TileMesh& tile : tiles)
    if (drawing.edge_width > 0) renderer.draw(edges_of_polygons(tile, drawing.edge_width));
  const Image image = renderer.finish();
  write_png(png, {image.width, image.height, 3}, std::as_bytes(std::span(image.rgb)));
}

}  // namespace voxweld::paper
