// A tile's mesh between stitch and encode. Kind "tile", a container with these sections:
//   1  TileHeader (one)
//   2  positions, i32 x 3
//   3  vertex ids, u64
//   4  PackedNormal x 3, or empty
//   5  triangles, u32 x 3
//   6  CornerNormal x 3, or empty
// and between labels
//   7  MaterialPair
//   8  the triangles' pairs, u32
// With labels.mode = "each" a file has a mesh for each of some labels. Sections of mesh i are
// i << 8 | the numbers above, and
//   9  the label of each mesh, u64
#pragma once

#include "storage/artifact/container.h"
#include "storage/types/material.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

inline constexpr std::array<char, 4> tile_kind = {'t', 'i', 'l', 'e'};
inline constexpr std::uint32_t tile_version = 6;

// A tile's figures, without its mesh.
struct TileHeader {
  std::uint64_t code = 0, level = 0;
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t quads = 0, polygon_triangles = 0, collinear = 0;
  double step = 0;
  std::uint64_t bits = 0;
  std::array<double, 3> origin{};

  CellKey key() const { return CellKey::of(code, level); }
};

// Of labels (labels.mode = "each") one mesh after the other, else one mesh.
class TileWriter {
 public:
  TileWriter(const std::filesystem::path& path, Hash128 key, bool of_labels);
  void add(Material material, const TileMesh& mesh);
  Hash128 finish();

 private:
  ArtifactWriter file_;
  bool of_labels_;
  std::vector<Material> materials_;
};

class TileArtifact : public OpenArtifact {
 public:
  explicit TileArtifact(const std::filesystem::path& path);

  // The labels of the meshes; empty where there is one mesh, of no label.
  const std::vector<Material>& labels() const { return labels_; }
  std::size_t meshes() const { return labels_.empty() ? 1 : labels_.size(); }
  TileHeader header(std::size_t mesh = 0) const;
  std::uint64_t label_pairs() const;  // how many the first mesh lists
  std::vector<MaterialPair> read_label_pairs() const;
  TileMesh read(std::size_t mesh = 0) const;

 private:
  std::vector<Material> labels_;
};

}  // namespace voxweld
