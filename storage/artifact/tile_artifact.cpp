#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

enum Section : std::uint64_t {
  header_section = 1,
  positions,
  ids,
  normals,
  triangles,
  corner_normals,
  pairs,
  triangle_pairs
};

constexpr std::uint64_t labels_section = 9;

void write_mesh(ArtifactWriter& file, std::uint64_t number, const TileMesh& mesh) {
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
  const std::uint64_t first = number << 8;
  file.section(first | header_section, std::as_bytes(std::span(&header, 1)));
  file.section(first | positions, std::as_bytes(std::span(mesh.positions)));
  file.section(first | ids, std::as_bytes(std::span(mesh.ids)));
  file.section(first | normals, std::as_bytes(std::span(mesh.normals)));
  file.section(first | triangles, std::as_bytes(std::span(mesh.triangles)));
  file.section(first | corner_normals, std::as_bytes(std::span(mesh.corner_normals)));
  if (!mesh.pairs.empty()) {
    file.section(first | pairs, std::as_bytes(std::span(mesh.pairs)));
    file.section(first | triangle_pairs, std::as_bytes(std::span(mesh.triangle_pairs)));
  }
}

}  // namespace

Hash128 write_tile(const std::filesystem::path& path, Hash128 key, const TileMesh& mesh) {
  ArtifactWriter file(path, {tile_kind, tile_version, key});
  write_mesh(file, 0, mesh);
  return file.commit();
}

LabelTilesWriter::LabelTilesWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {tile_kind, tile_version, key}) {}

void LabelTilesWriter::add(Material label, const TileMesh& mesh) {
  write_mesh(file_, labels_.size(), mesh);
  labels_.push_back(label);
}

Hash128 LabelTilesWriter::finish() {
  file_.section(labels_section, std::as_bytes(std::span(labels_)));
  return file_.commit();
}

TileArtifact::TileArtifact(const std::filesystem::path& path)
    : file_(path, tile_kind, tile_version) {
  if (file_.find(labels_section) != nullptr) file_.read_array(labels_section, labels_);
}

TileHeader TileArtifact::header(std::size_t mesh) const {
  std::vector<TileHeader> headers;
  file_.read_array(std::uint64_t{mesh} << 8 | header_section, headers);
  if (headers.size() != 1 || headers[0].level > max_levels || headers[0].bits > max_lattice_bits)
    file_.damaged("has no valid header");
  return headers[0];
}

std::uint64_t TileArtifact::label_pairs() const {
  const SectionRecord* section = file_.find(pairs);
  return section == nullptr ? 0 : section->size / sizeof(MaterialPair);
}

std::vector<MaterialPair> TileArtifact::read_label_pairs() const {
  std::vector<MaterialPair> list;
  if (file_.find(pairs) != nullptr) file_.read_array(pairs, list);
  return list;
}

TileMesh TileArtifact::read(std::size_t number) const {
  const TileHeader h = header(number);
  const std::uint64_t first = std::uint64_t{number} << 8;
  TileMesh mesh;
  mesh.tile = h.key();
  mesh.lattice = {h.step, static_cast<int>(h.bits), h.origin};
  mesh.quads = h.quads;
  mesh.polygon_triangles = h.polygon_triangles;
  mesh.collinear = h.collinear;
  file_.read_array(first | positions, mesh.positions);
  file_.read_array(first | ids, mesh.ids);
  file_.read_array(first | normals, mesh.normals);
  file_.read_array(first | triangles, mesh.triangles);
  file_.read_array(first | corner_normals, mesh.corner_normals);
  if (file_.find(first | pairs) != nullptr) {
    file_.read_array(first | pairs, mesh.pairs);
    file_.read_array(first | triangle_pairs, mesh.triangle_pairs);
    if (mesh.triangle_pairs.size() != mesh.triangles.size())
      file_.damaged("its sections contradict each other");
    for (const std::uint32_t pair : mesh.triangle_pairs)
      if (pair >= mesh.pairs.size())
        file_.damaged("a triangle names a label pair that is not there");
  }
  const bool normals_fit =
      mesh.normals.empty() || (mesh.normals.size() == mesh.positions.size() &&
                               mesh.corner_normals.size() == mesh.triangles.size());
  if (mesh.positions.size() != h.vertices || mesh.ids.size() != h.vertices ||
      mesh.triangles.size() != h.triangles || !normals_fit)
    file_.damaged("its sections contradict each other");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= h.vertices) file_.damaged("a triangle refers to a vertex that is not there");
  return mesh;
}

}  // namespace voxweld
