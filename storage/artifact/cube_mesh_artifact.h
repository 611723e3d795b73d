// A part of a surface's mesh, sorted by the cubes its triangles are at home in: what passes between
// stitch, refine, seams, mend, remend and retile. With labels.mode = "each" parts of the surfaces of some
// labels. Those of mend and remend are patches: each piece has boxes, and its triangles stand in place of
// all those before it that are at home in its cube and have all corners in one of its boxes. Where a mesh
// is only repaired, refine's has no pieces, and that of seams is a patch of stitch's.
// Kind "cubm", a container with these sections:
//   1                    CubeMeshSummary (one)
//   2                    CubePieceRecord of each piece, ascending by label, code and cube
//   3                    what its maker counted, plain data of that maker, or empty
//   4                    BlockRecord of each block with a triangle, ascending by label and code
//   5                    LabelChange of each label that lost vertices, ascending
//   6                    IntersectionRecord of each triangle that still intersects another: of the
//                        stages that mend follows
//   (piece + 1) << 8 | 1 of the piece's triangles those inside the cube, where there are any
//   (piece + 1) << 8 | 2 and those that leave it
//   (piece + 1) << 8 | 3 of a patch's piece the boxes, which do not meet: LatticeBox
// A part stands for itself:
//   u64 x 8 vertices, triangles, samples, triangles with sides (all or none), 1 where there are
//   normals, 1 where there are aims, 1 where intersections have been looked for, and how many triangles
//   intersect; then of the vertices positions, i32 x 3, ids, u64, normals, PackedNormal x 3, and aims,
//   i32 x 3; of the triangles corners, u32 x 3, and sides, u64 x 2; SurfaceSample of the samples; and
//   the numbers of the triangles that intersect, u32
#pragma once

#include <compare>

#include "storage/artifact/container.h"
#include "storage/types/material.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

inline constexpr std::array<char, 4> cube_mesh_kind = {'c', 'u', 'b', 'm'};
inline constexpr std::uint32_t cube_mesh_version = 6;

struct PartCounts {
  std::uint64_t vertices = 0, triangles = 0, samples = 0;
  std::uint64_t sided = 0;  // triangles that have sides

  PartCounts& operator+=(const PartCounts& other) {
    vertices += other.vertices;
    triangles += other.triangles;
    samples += other.samples;
    sided += other.sided;
    return *this;
  }
};

PartCounts counts_of(const RefineMesh& mesh);

enum class CubePart : std::uint8_t { inside = 1, leaving = 2 };

// What is wanted of a part beside its vertices' positions and ids, its triangles and their sides.
struct PartFields {
  bool normals = true, aims = true, samples = true;
};

// Where a piece lies among all: by label first. label: 0 where there is one surface. code: by which
// ranges of cubes are given.
struct CubeKey {
  Material label = 0;
  std::uint64_t code = 0;
  friend constexpr auto operator<=>(const CubeKey&, const CubeKey&) = default;
};

struct CubePieceRecord {
  Material label = 0;
  std::uint64_t code = 0;
  std::uint64_t cube = 0;  // Morton number
  PartCounts inside, leaving;
  LatticeBox leaving_box;     // around them, where there are any
  std::uint64_t holes = 0;    // boxes, of a patch
  std::uint64_t removed = 0;  // triangles before it in whose place it stands

  CubeKey key() const { return {label, code}; }
};

// The triangles of one block of cells (stages/refine/retile.h). Of a patch how many more there are than
// below it, modulo 2^64.
struct BlockRecord {
  Material label = 0;
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  std::uint64_t triangles = 0;
  friend bool operator==(const BlockRecord&, const BlockRecord&) = default;
};

// What became of a label's surface since it was stitched, in the cubes of one unit.
struct LabelChange {
  Material label = 0;
  std::uint64_t lost_vertices = 0;
  friend bool operator==(const LabelChange&, const LabelChange&) = default;
};

// A triangle that still intersects another.
struct IntersectionRecord {
  Material label = 0;
  LatticeBox box;            // around it
  std::uint64_t around = 0;  // triangles at home in the same cube of the pass
  friend bool operator==(const IntersectionRecord&, const IntersectionRecord&) = default;
};

struct CubeMeshSummary {
  std::uint64_t pieces = 0;
  PartCounts all;               // vertices once for each part that has them
  std::uint64_t leaving = 0;    // triangles
  CubeKey lowest, highest;      // where there are pieces
  LatticeBox box, leaving_box;  // where there are such triangles
};

// What stands in an artifact beside its pieces.
struct CubeMeshTables {
  std::span<const std::byte> counted;  // as section 3
  std::span<const BlockRecord> blocks = {};
  std::span<const LabelChange> changes = {};
  std::span<const IntersectionRecord> intersecting = {};
};

// Where a piece of a patch stands in place of what was before, and of how many triangles.
struct PieceHoles {
  std::span<const LatticeBox> boxes = {};
  std::uint64_t removed = 0;
};

class CubeMeshWriter {
 public:
  CubeMeshWriter(const std::filesystem::path& path, Hash128 key)
      : file_(path, {cube_mesh_kind, cube_mesh_version, key}) {}

  // Ascending by key, then by cube.
  void piece(CubeKey key, Index3 cube, const RefineMesh& inside, const RefineMesh& leaving,
             const PieceHoles& holes = {});
  Hash128 finish(const CubeMeshTables& tables);

 private:
  PartCounts part(CubePart which, const RefineMesh& mesh);
  void add(const PartCounts& counts, const LatticeBox& box, bool leaving);  // to the summary

  ArtifactWriter file_;
  CubeMeshSummary summary_;
  std::vector<CubePieceRecord> pieces_;
};

// Thread-safe. DamagedArtifact when something fails its checks, StorageError when it cannot be read.
class CubeMeshArtifact : public OpenArtifact {
 public:
  explicit CubeMeshArtifact(const std::filesystem::path& path);

  const CubeMeshSummary& summary() const { return summary_; }
  std::span<const CubePieceRecord> pieces() const { return pieces_; }
  // Of an empty part the same for all.
  Hash128 part_hash(std::size_t piece, CubePart part) const;
  RefineMesh read(std::size_t piece, CubePart part, const PartFields& wanted = {}) const;
  std::vector<LatticeBox> holes(std::size_t piece) const;
  Hash128 holes_hash(std::size_t piece) const;  // where there are none the same for all
  template <class T>
  T counted() const {
    return file_.read_record<T>(3, "has no counts of its making");
  }
  std::vector<BlockRecord> blocks() const;
  std::vector<LabelChange> changes() const;
  std::vector<IntersectionRecord> intersecting() const;
  // Without reading them: how many, and whether there are blocks or changes.
  std::uint64_t intersecting_count() const;
  bool counts_triangles() const;

 private:
  Hash128 hash_of(std::uint64_t section) const;
  std::uint64_t size_of(std::uint64_t section) const;

  CubeMeshSummary summary_;
  std::vector<CubePieceRecord> pieces_;
};

}  // namespace voxweld
