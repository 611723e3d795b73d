// STL, text and binary: triangles, each with its own three corners. Stored normals are not read:
// the corners say it better.
#include "storage/meshes/mesh_formats.h"
#include "storage/support/byte_order.h"

namespace voxweld {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

Vec3 place_at(const std::byte* at) {
  const auto coordinate = [at](std::size_t offset) -> double {
    return load_as<float>(at, offset, std::endian::little);
  };
  return {coordinate(0), coordinate(4), coordinate(8)};
}

void parse_binary(MeshStream& file, std::uint64_t count, MeshOutput& out) {
  file.take(header_bytes);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto bytes = file.take(triangle_bytes);
    if (bytes.size() < triangle_bytes) file.fail("ends within a triangle: truncated");
    out.facet({place_at(&bytes[12]), place_at(&bytes[24]), place_at(&bytes[36])});
  }
}

void parse_text(MeshStream& file, MeshOutput& out) {
  MeshLines lines(file, {});
  std::array<Vec3, 3> corners;
  std::size_t open = 0;  // corners of the triangle at hand
  while (lines.next()) {
    const std::string_view word = lines.words()[0];
    if (word == "vertex") {
      const Vec3 place = lines.place(1);
      if (open == 3) lines.fail("a fourth vertex; expected triangles");
      corners[open++] = place;
    } else if (word == "endloop") {
      if (open != 3) lines.fail(fmt::format("expected three vertices, found {}", open));
      out.facet(corners);
      open = 0;
    } else if (word != "solid" && word != "facet" && word != "outer" && word != "endfacet" &&
               word != "endsolid") {
      lines.fail(fmt::format("expected \"facet\", \"vertex\" or the like, found \"{}\"",
                             word.substr(0, 40)));
    }
  }
  if (open != 0) file.fail("ends within a triangle: truncated");
}

bool begins_with_solid(MeshStream& file) {
  constexpr std::size_t looked_at = 4096;
  const auto bytes = file.peek(looked_at);
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin != text.npos && text.substr(begin).starts_with("solid");
}

}  // namespace

void parse_stl(MeshStream& file, MeshOutput& out) {
  // Binary headers may begin with "solid" too, so the size decides first.
  const bool has_header = file.size() >= header_bytes;
  const std::uint64_t count =
      has_header ? load_as<std::uint32_t>(file.peek(header_bytes).data(), 80, std::endian::little)
                 : 0;
  const std::uint64_t expected = header_bytes + count * triangle_bytes;
  if (has_header && file.size() == expected) return parse_binary(file, count, out);
  if (begins_with_solid(file) && !file.holds_zero()) return parse_text(file, out);
  if (!has_header) file.fail("expected an STL file, found less than its header: truncated");
  if (file.size() > expected) return parse_binary(file, count, out);  // padded
  file.fail(
      fmt::format("truncated: {} triangles take {} bytes, found {}", count, expected, file.size()));
}

}  // namespace voxweld
