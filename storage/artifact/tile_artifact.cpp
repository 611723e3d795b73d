#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

enum Section : std::uint64_t {
  header_section = 1,
  positions,
  ids,
  normals,
  triangles,
  corner_clusters,
  pairs,
  triangle_pairs
};

}  // namespace

Hash128 write_tile(const std::filesystem::path& path, Hash128 key, const TileMesh& mesh) {
  const TileHeader header{mesh.tile.code(),
                          static_cast<std::uint64_t>(mesh.tile.level),
                          mesh.positions.size(),
                          mesh.triangles.size(),
                          mesh.quads,
                          mesh.polygon_triangles,
                          mesh.collinear,
                          mesh.lattice.step,
                          static_cast<std::uint64_t>(mesh.lattice.bits),
                          mesh.lattice.origin};
  ArtifactWriter file(path, {tile_kind, tile_version, key});
  file.section(header_section, std::as_bytes(std::span(&header, 1)));
  file.section(positions, std::as_bytes(std::span(mesh.positions)));
  file.section(ids, std::as_bytes(std::span(mesh.ids)));
  file.section(normals, std::as_bytes(std::span(mesh.normals)));
  file.section(triangles, std::as_bytes(std::span(mesh.triangles)));
  file.section(corner_clusters, std::as_bytes(std::span(mesh.corner_clusters)));
  if (!mesh.pairs.empty()) {
    file.section(pairs, std::as_bytes(std::span(mesh.pairs)));
    file.section(triangle_pairs, std::as_bytes(std::span(mesh.triangle_pairs)));
  }
  return file.commit();
}

TileArtifact::TileArtifact(const std::filesystem::path& path)
    : file_(path, tile_kind, tile_version) {}

TileHeader TileArtifact::header() const {
  std::vector<TileHeader> headers;
  file_.read_array(header_section, headers);
  if (headers.size() != 1 || headers[0].level > max_levels || headers[0].bits > max_lattice_bits)
    file_.damaged("has no valid header");
  return headers[0];
}

TileMesh TileArtifact::read() const {
  const TileHeader h = header();
  TileMesh mesh;
  mesh.tile = h.key();
  mesh.lattice = {h.step, static_cast<int>(h.bits), h.origin};
  mesh.quads = h.quads;
  mesh.polygon_triangles = h.polygon_triangles;
  mesh.collinear = h.collinear;
  file_.read_array(positions, mesh.positions);
  file_.read_array(ids, mesh.ids);
  file_.read_array(normals, mesh.normals);
  file_.read_array(triangles, mesh.triangles);
  file_.read_array(corner_clusters, mesh.corner_clusters);
  if (file_.find(pairs) != nullptr) {
    file_.read_array(pairs, mesh.pairs);
    file_.read_array(triangle_pairs, mesh.triangle_pairs);
    if (mesh.triangle_pairs.size() != mesh.triangles.size())
      file_.damaged("its sections contradict each other");
    for (const std::uint32_t pair : mesh.triangle_pairs)
      if (pair >= mesh.pairs.size())
        file_.damaged("a triangle names a label pair that is not there");
  }
  const bool normals_fit =
      mesh.normals.empty() || (mesh.normals.size() == mesh.positions.size() &&
                               mesh.corner_clusters.size() == mesh.triangles.size());
  if (mesh.positions.size() != h.vertices || mesh.ids.size() != h.vertices ||
      mesh.triangles.size() != h.triangles || !normals_fit)
    file_.damaged("its sections contradict each other");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= h.vertices) file_.damaged("a triangle refers to a vertex that is not there");
  return mesh;
}

}  // namespace voxweld
