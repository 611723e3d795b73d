// What a unit of refine, seams, mend or retile reads: pieces of the meshes that the stage before left.
#pragma once

#include <algorithm>
#include <mutex>
#include <vector>

#include "pipeline/config/settings.h"
#include "stages/refine/cube_lattice.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/hash.h"

namespace voxweld {

// Where the pieces of artifacts lie, which come in the order of their labels.
class PieceSpans {
 public:
  // Of the next artifact. With again = true labels begin anew there.
  void add(std::uint64_t pieces, const CubeKey& lowest, const CubeKey& highest, bool again);
  // f(number) of each artifact that may have pieces from `begin` on and before `end`, ascending.
  template <class F>
  void each(const CubeKey& begin, const CubeKey& end, F&& f) const {
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const auto first = spans_.begin() + runs_[run];
      const auto last = run + 1 < runs_.size() ? spans_.begin() + runs_[run + 1] : spans_.end();
      auto span = std::partition_point(
          first, last, [&](const Span& other) { return other.highest_so_far < begin; });
      for (; span != last && (!span->any || span->lowest.label <= end.label); ++span)
        if (span->any && begin <= span->highest && span->lowest < end)
          f(static_cast<std::size_t>(span - spans_.begin()));
    }
  }

 private:
  struct Span {
    bool any = false;
    CubeKey lowest, highest, highest_so_far;
  };
  std::vector<Span> spans_;
  std::vector<std::ptrdiff_t> runs_;  // where labels begin anew
};

// f(number, record) of the artifact's pieces from `begin` on and before `end`.
template <class F>
void each_piece_of(const CubeMeshArtifact& artifact, const CubeKey& begin, const CubeKey& end,
                   F&& f) {
  const auto pieces = artifact.pieces();
  const auto first = std::ranges::lower_bound(pieces, begin, {}, &CubePieceRecord::key);
  for (auto piece = first; piece != pieces.end() && piece->key() < end; ++piece)
    f(static_cast<std::size_t>(piece - pieces.begin()), *piece);
}

// The artifacts of all units of a stage, in their order.
struct MeshLayer {
  Stage maker = Stage::stitch;
  std::vector<std::filesystem::path> paths;
};

// A mesh: what one stage left, and patches that others laid over it, whose pieces take triangles out of
// those of the same label and cube in the layers below. What of each artifact is needed to find pieces is
// held, and read when it is first asked for; some of the artifacts are held open. Thread-safe.
class CubeMeshes {
 public:
  struct Entry {
    CubeMeshSummary summary;
    Hash128 content;
    std::uint64_t intersecting = 0;  // records of triangles that intersect others
    bool counts = false;  // whether it says how many triangles there are, or vertices lost
  };

  // From the lowest layer to the uppermost.
  explicit CubeMeshes(std::vector<MeshLayer> layers);

  // Whose the artifact is.
  std::size_t layer(std::size_t artifact) const { return artifacts_[artifact].layer; }
  bool begins_layer(std::size_t artifact) const {
    return artifact == 0 || layer(artifact) != layer(artifact - 1);
  }
  std::size_t size() const { return artifacts_.size(); }
  const std::filesystem::path& path(std::size_t artifact) const {
    return artifacts_[artifact].path;
  }
  // InputError where an artifact is missing.
  const std::vector<Entry>& entries();
  const PieceSpans& spans() {
    entries();
    return spans_;
  }
  // Those with pieces there, ascending: from `first` on and before `end`.
  std::vector<Material> labels(Material first, Material end);
  std::shared_ptr<const CubeMeshArtifact> open(std::size_t artifact);

  // What is there of a part of a piece: without what patches have taken out. spans: of all artifacts,
  // where it is not spans().
  RefineMesh read(std::size_t artifact, std::size_t piece, CubePart part,
                  const PartFields& wanted = {}) {
    return read(spans(), artifact, piece, part, wanted);
  }
  RefineMesh read(const PieceSpans& spans, std::size_t artifact, std::size_t piece, CubePart part,
                  const PartFields& wanted = {});
  // Feeds what that is made of.
  void add_hashes(KeyHasher& key, std::size_t artifact, std::size_t piece, CubePart part) {
    add_hashes(key, spans(), artifact, piece, part);
  }
  void add_hashes(KeyHasher& key, const PieceSpans& spans, std::size_t artifact, std::size_t piece,
                  CubePart part);

 private:
  static constexpr std::size_t most_open = 64;

  // f(artifact, number in it) of the patches' pieces over this one.
  template <class F>
  void each_over(const PieceSpans& spans, std::size_t artifact, const CubePieceRecord& piece,
                 F&& f);

  struct Artifact {
    Stage maker = Stage::stitch;
    std::size_t layer = 0;
    std::filesystem::path path;
  };
  std::vector<Artifact> artifacts_;
  std::once_flag looked_;
  std::vector<Entry> entries_;
  PieceSpans spans_;
  BoundedCache<CubeMeshArtifact> open_{most_open};
};

// A piece to read: all of it, or of those triangles that leave its cube the ones near enough.
struct PieceRead {
  std::size_t artifact = 0, piece = 0;
  bool whole = false;
};

// A part of such a piece.
struct PartRead {
  PieceRead piece;
  CubePart part = CubePart::inside;
  std::uint64_t cube = 0, vertices = 0;
  bool last = false;  // no part that follows has a vertex that is new with this one
};
// Beside those that are there the parts of one more piece.
void add_parts(const PieceRead& read, const CubePieceRecord& piece, std::vector<PartRead>& parts);
// Puts parts of one label in the order in which one mesh is made of them soonest. Returns how many
// vertices are looked for in several parts, at most.
std::uint64_t put_in_order(std::vector<PartRead>& parts);
// Not in order.
std::vector<PartRead> parts_of(CubeMeshes& meshes, const std::vector<PieceRead>& pieces);

// What refining the cubes of a range takes, of one label: the pieces at home there; and of all others
// of that label those triangles that leave their cube and meet one of the cubes with a piece, or the
// box around what leaves such a piece. No triangle that stays in a cube of others is near enough to
// matter: refine_range looks at nothing that does not meet a cube of its own.
class RangeReads {
 public:
  // label: 0 of one surface.
  RangeReads(CubeMeshes& meshes, const CubeLattice& cubes, Material label, const CubeRange& own);

  Material label() const { return label_; }
  void add_hashes(KeyHasher& key) const;
  const PartCounts& own() const { return own_; }  // of the pieces at home
  const PartCounts& all() const { return all_; }  // and others', at most
  std::uint64_t largest_part_bytes() const { return largest_part_; }
  // between: called before each piece.
  RefineMesh read(const std::function<void()>& between, const PartFields& wanted = {}) const;

 private:
  void add_own(const CubeLattice& cubes, const CubeRange& own);
  void add_others(const CubeRange& own);
  void add(const PieceRead& read, const CubePieceRecord& piece);

  CubeMeshes& meshes_;
  Material label_;
  std::vector<PieceRead> pieces_;
  std::vector<LatticeBox> near_;
  PartCounts own_, all_;
  std::uint64_t largest_part_ = 0;
};

// As it is read and as it lies in memory.
std::uint64_t part_bytes(const PartCounts& counts);

}  // namespace voxweld
