// What a unit of refine, seams or retile reads: pieces of the meshes that the stage before left.
#pragma once

#include <mutex>
#include <vector>

#include "pipeline/config/settings.h"
#include "stages/refine/cube_lattice.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/hash.h"

namespace voxweld {

// The artifacts of one stage. What of each is needed to find pieces is held, and read when it is
// first asked for; some of the artifacts are held open. Thread-safe.
class CubeMeshes {
 public:
  struct Entry {
    CubeMeshSummary summary;
    Hash128 content;
  };

  // paths: of all units of `maker`, in their order.
  CubeMeshes(Stage maker, std::vector<std::filesystem::path> paths)
      : maker_(maker), paths_(std::move(paths)) {}

  std::size_t size() const { return paths_.size(); }
  const std::filesystem::path& path(std::size_t artifact) const { return paths_[artifact]; }
  // InputError where an artifact is missing.
  const std::vector<Entry>& entries();
  std::shared_ptr<const CubeMeshArtifact> open(std::size_t artifact);

 private:
  static constexpr std::size_t most_open = 64;

  Stage maker_;
  std::vector<std::filesystem::path> paths_;
  std::once_flag looked_;
  std::vector<Entry> entries_;
  BoundedCache<CubeMeshArtifact> open_{most_open};
};

// A piece to read: all of it, or of those triangles that leave its cube the ones near enough.
struct PieceRead {
  std::size_t artifact = 0, piece = 0;
  bool whole = false;
};

// What refining the cubes of a range takes: the pieces at home there; and of all others those
// triangles that leave their cube and meet one of the cubes with a piece, or the box around what
// leaves such a piece. No triangle that stays in a cube of others is near enough to matter:
// refine_range looks at nothing that does not meet a cube of its own.
class RangeReads {
 public:
  RangeReads(CubeMeshes& meshes, const CubeLattice& cubes, const CubeRange& own);

  void add_hashes(KeyHasher& key) const;
  const PartCounts& own() const { return own_; }  // of the pieces at home
  const PartCounts& all() const { return all_; }  // and others', at most
  std::uint64_t largest_part_bytes() const { return largest_part_; }
  // between: called before each piece.
  RefineMesh read(const std::function<void()>& between) const;

 private:
  void add_own(const CubeLattice& cubes, const CubeRange& own);
  void add_others(const CubeRange& own);
  void add(const PieceRead& read, const CubePieceRecord& piece);

  CubeMeshes& meshes_;
  std::vector<PieceRead> pieces_;
  std::vector<LatticeBox> near_;
  PartCounts own_, all_;
  std::uint64_t largest_part_ = 0;
};

// As it is read and as it lies in memory.
std::uint64_t part_bytes(const PartCounts& counts);

}  // namespace voxweld
