// STL, text and binary: triangles, each with its own three corners. Stored normals are not read:
// the corners say it better.
#include "storage/readers/byte_order.h"
#include "storage/readers/mesh_formats.h"

namespace voxweld {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

double coordinate(const std::byte* at) {
  return load_as<float>(at, 0, std::endian::little);
}

void close_triangle(TriangleMesh& mesh) {
  const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

TriangleMesh parse_binary(const MeshBytes& file, std::uint64_t count) {
  if (count > most_mesh_triangles)
    file.fail(fmt::format("more than {} triangles", most_mesh_triangles));
  TriangleMesh mesh;
  mesh.vertices.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::byte* corner = file.bytes.data() + header_bytes + i * triangle_bytes + 12;
    for (int c = 0; c < 3; ++c, corner += 12)
      mesh.vertices.push_back({coordinate(corner), coordinate(corner + 4), coordinate(corner + 8)});
    close_triangle(mesh);
  }
  return mesh;
}

TriangleMesh parse_text(const MeshBytes& file) {
  TriangleMesh mesh;
  MeshLines lines(file, {});
  std::size_t open = 0;  // corners of the triangle at hand
  while (lines.next()) {
    const std::string_view word = lines.words()[0];
    if (word == "vertex") {
      mesh.vertices.push_back(lines.place(1));
      if (++open > 3) lines.fail("a fourth vertex; expected triangles");
    } else if (word == "endloop") {
      if (open != 3) lines.fail(fmt::format("expected three vertices, found {}", open));
      close_triangle(mesh);
      open = 0;
    } else if (word != "solid" && word != "facet" && word != "outer" && word != "endfacet" &&
               word != "endsolid") {
      lines.fail(fmt::format("expected \"facet\", \"vertex\" or the like, found \"{}\"",
                             word.substr(0, 40)));
    }
  }
  if (open != 0) file.fail("ends within a triangle: truncated");
  return mesh;
}

}  // namespace

TriangleMesh parse_stl(const MeshBytes& file) {
  // Binary headers may begin with "solid" too, so the size decides first.
  const bool has_header = file.bytes.size() >= header_bytes;
  const std::uint64_t count =
      has_header ? load_as<std::uint32_t>(file.bytes.data(), 80, std::endian::little) : 0;
  const std::uint64_t expected = header_bytes + count * triangle_bytes;
  if (has_header && file.bytes.size() == expected) return parse_binary(file, count);
  const std::string_view text = file.text();
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin != text.npos && text.substr(begin).starts_with("solid") && text.find('\0') == text.npos)
    return parse_text(file);
  if (!has_header) file.fail("expected an STL file, found less than its header: truncated");
  if (file.bytes.size() > expected) return parse_binary(file, count);  // padded
  file.fail(fmt::format("truncated: {} triangles take {} bytes, found {}", count, expected,
                        file.bytes.size()));
}

}  // namespace voxweld
