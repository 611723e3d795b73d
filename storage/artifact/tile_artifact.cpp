#include "storage/artifact/tile_artifact.h"

namespace voxweld {
namespace {

enum TileSection : std::uint64_t {
  header_section = 1,
  positions_section,
  ids_section,
  normals_section,
  triangles_section,
  corner_normals_section,
  pairs_section,
  triangle_pairs_section
};

constexpr std::uint64_t tile_labels_section = 9;

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
  file.section(first | header_section, as_record(header));
  file.section(first | positions_section, as_section(mesh.positions));
  file.section(first | ids_section, as_section(mesh.ids));
  file.section(first | normals_section, as_section(mesh.normals));
  file.section(first | triangles_section, as_section(mesh.triangles));
  file.section(first | corner_normals_section, as_section(mesh.corner_normals));
  if (!mesh.pairs.empty()) {
    file.section(first | pairs_section, as_section(mesh.pairs));
    file.section(first | triangle_pairs_section, as_section(mesh.triangle_pairs));
  }
}

}  // namespace

TileWriter::TileWriter(const std::filesystem::path& path, Hash128 key, bool of_labels)
    : file_(path, {tile_kind, tile_version, key}), of_labels_(of_labels) {}

void TileWriter::add(Material material, const TileMesh& mesh) {
  write_mesh(file_, materials_.size(), mesh);
  materials_.push_back(material);
}

Hash128 TileWriter::finish() {
  if (of_labels_) file_.section(tile_labels_section, as_section(materials_));
  return file_.commit();
}

TileArtifact::TileArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, tile_kind, tile_version) {
  if (file_.find(tile_labels_section) != nullptr) file_.read_array(tile_labels_section, labels_);
}

TileHeader TileArtifact::header(std::size_t mesh) const {
  constexpr const char* wrong = "has no valid header";
  const auto header =
      file_.read_record<TileHeader>(std::uint64_t{mesh} << 8 | header_section, wrong);
  if (header.level > max_levels || header.bits > max_lattice_bits) file_.damaged(wrong);
  return header;
}

std::uint64_t TileArtifact::label_pairs() const {
  const SectionRecord* section = file_.find(pairs_section);
  return section == nullptr ? 0 : section->size / sizeof(MaterialPair);
}

std::vector<MaterialPair> TileArtifact::read_label_pairs() const {
  if (file_.find(pairs_section) == nullptr) return {};
  return file_.read_array<MaterialPair>(pairs_section);
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
  file_.read_array(first | positions_section, mesh.positions);
  file_.read_array(first | ids_section, mesh.ids);
  file_.read_array(first | normals_section, mesh.normals);
  file_.read_array(first | triangles_section, mesh.triangles);
  file_.read_array(first | corner_normals_section, mesh.corner_normals);
  if (file_.find(first | pairs_section) != nullptr) {
    file_.read_array(first | pairs_section, mesh.pairs);
    file_.read_array(first | triangle_pairs_section, mesh.triangle_pairs);
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
