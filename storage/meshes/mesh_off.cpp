// OFF and OBJ: texts of vertices and polygons. Colours, normals and texture coordinates are passed
// over.
#include "storage/meshes/mesh_formats.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

// What a file says it holds, before anything is allocated for it: each takes a line of two bytes at
// the least.
std::int64_t announced(const MeshStream& file, const MeshLines& lines, std::size_t word) {
  const std::int64_t count = lines.whole(word);
  if (count < 0 || static_cast<std::uint64_t>(count) > file.size() / 2)
    lines.fail(fmt::format("announces {} items, more than a file of {} bytes can hold", count,
                           file.size()));
  return count;
}

}  // namespace

void parse_off(MeshStream& file, MeshOutput& out) {
  MeshLines lines(file, "#");
  if (!lines.next()) file.fail("expected an OFF file, found nothing");
  const std::string_view magic = lines.words()[0];
  if (!magic.ends_with("OFF") || magic.size() > 6 || magic.starts_with("4") ||
      magic.find('n') != magic.npos || (lines.words().size() > 1 && lines.words()[1] == "BINARY"))
    lines.fail(
        fmt::format("expected a text beginning with \"OFF\", found \"{}\"", magic.substr(0, 40)));
  std::size_t counts = 1;  // they may stand on the line of the magic word
  if (lines.words().size() == 1) {
    if (!lines.next()) file.fail("ends after its first line: truncated");
    counts = 0;
  }
  const std::int64_t vertices = announced(file, lines, counts);
  const std::int64_t faces = announced(file, lines, counts + 1);
  for (std::int64_t i = 0; i < vertices; ++i) {
    if (!lines.next())
      file.fail(fmt::format("truncated: {} vertices announced, {} found", vertices, i));
    out.vertex(lines.place(0));
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    if (!lines.next()) file.fail(fmt::format("truncated: {} faces announced, {} found", faces, i));
    const std::int64_t corners = lines.whole(0);
    out.begin_polygon();
    for (std::int64_t c = 1; c <= corners; ++c) {
      const std::int64_t vertex = lines.whole(static_cast<std::size_t>(c));
      if (!out.corner(vertex))
        lines.fail(fmt::format("vertex {} of {}: there is none of that number", vertex, vertices));
    }
  }
}

void parse_obj(MeshStream& file, MeshOutput& out) {
  MeshLines lines(file, "#");
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "v") out.vertex(lines.place(1));
    if (words[0] != "f") continue;
    out.begin_polygon();
    for (std::size_t i = 1; i < words.size(); ++i) {
      // vertex, vertex/texture, vertex//normal or vertex/texture/normal; from 1, or from the end
      // where negative.
      const auto number = parse_integer(words[i].substr(0, words[i].find('/')));
      const auto count = static_cast<std::int64_t>(out.vertices());
      if (!number || !out.corner(*number < 0 ? count + *number : *number - 1))
        lines.fail(
            fmt::format("face corner \"{}\": expected the number of a vertex, of which there "
                        "are {} so far",
                        words[i], count));
    }
  }
}

}  // namespace voxweld
