// A part of a surface's mesh, sorted by the cubes its triangles are at home in: what passes between
// stitch, refine, seams and retile. Kind "cubm", a container with these sections:
//   1                    CubeMeshSummary (one)
//   2                    CubePieceRecord of each piece, ascending by code, then by cube
//   3                    what its maker counted, plain data of that maker, or empty
//   4                    CubeCount of each block with a triangle (polygons: their number), ascending
//   (piece + 1) << 8 | 1 of the piece's triangles those inside the cube, where there are any
//   (piece + 1) << 8 | 2 and those that leave it
// A part stands for itself:
//   u64 x 7 vertices, triangles, samples, 1 where there are normals, 1 where there are aims, 1 where
//   intersections have been looked for, and how many triangles intersect; then of the vertices
//   positions, i32 x 3, ids, u64, normals, PackedNormal x 3, and aims, i32 x 3; of the triangles corners, u32 x 3; SurfaceSample of the samples;
//   and the numbers of the triangles that intersect, u32
#pragma once

#include "storage/artifact/container.h"
#include "storage/types/refine_mesh.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> cube_mesh_kind = {'c', 'u', 'b', 'm'};
inline constexpr std::uint32_t cube_mesh_version = 2;

struct PartCounts {
  std::uint64_t vertices = 0, triangles = 0, samples = 0;

  PartCounts& operator+=(const PartCounts& other) {
    vertices += other.vertices;
    triangles += other.triangles;
    samples += other.samples;
    return *this;
  }
};

enum class CubePart : std::uint8_t { inside = 1, leaving = 2 };

struct CubePieceRecord {
  std::uint64_t code = 0;  // by which ranges of cubes are given
  std::uint64_t cube = 0;  // Morton number
  PartCounts inside, leaving;
  LatticeBox leaving_box;  // around them, where there are any
};

struct CubeMeshSummary {
  std::uint64_t pieces = 0;
  PartCounts all;                                   // vertices once for each part that has them
  std::uint64_t leaving = 0;                        // triangles
  std::uint64_t lowest_code = 0, highest_code = 0;  // where there are pieces
  LatticeBox box, leaving_box;                      // where there are such triangles
};

class CubeMeshWriter {
 public:
  CubeMeshWriter(const std::filesystem::path& path, Hash128 key)
      : file_(path, {cube_mesh_kind, cube_mesh_version, key}) {}

  // Ascending by code, then by cube.
  void piece(std::uint64_t code, Index3 cube, const RefineMesh& inside, const RefineMesh& leaving);
  // counted: as section 3.
  Hash128 finish(std::span<const std::byte> counted, std::span<const CubeCount> blocks);

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
  RefineMesh read(std::size_t piece, CubePart part) const;
  template <class T>
  T counted() const {
    return file_.read_record<T>(3, "has no counts of its making");
  }
  std::vector<CubeCount> blocks() const;

 private:
  CubeMeshSummary summary_;
  std::vector<CubePieceRecord> pieces_;
};

}  // namespace voxweld
