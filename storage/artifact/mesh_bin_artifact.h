// A mesh on disk, cut up by the bricks of a volume.
//
// Kind "mesh", one for a file: a container with one section
//   1  a MeshRecord
// Kind "mbin", the bins of one shard's bricks, where a triangle reaches any of them:
//   1            one byte for each brick of the shard, x fastest: a MeshSide
//   2 + 2 brick  where a triangle reaches it: corners, three of each triangle, x y z i64 each, in
//                steps of 2^-20 of a cell
//   3 + 2 brick  and MeshBin::first
// Kind "mtab", which says what there is of the latter, written after all of them:
//   1  a MeshTableFacts
//   2  one byte for each shard, x fastest: a MeshSide
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "storage/artifact/container.h"
#include "storage/types/mesh_bin.h"

namespace voxweld {

inline constexpr std::array<char, 4> mesh_record_kind = {'m', 'e', 's', 'h'};
inline constexpr std::array<char, 4> mesh_bins_kind = {'m', 'b', 'i', 'n'};
inline constexpr std::array<char, 4> mesh_table_kind = {'m', 't', 'a', 'b'};
inline constexpr std::uint32_t mesh_record_version = 2, mesh_bins_version = 1;

// What reading a mesh file found out; coordinates are the file's own.
struct MeshRecord {
  Hash128 content;  // of the file
  FileState file;   // when it was read
  std::uint64_t vertices = 0, triangles = 0;
  Vec3 lo, hi;          // of its triangles
  Vec3 all_lo, all_hi;  // of its vertices, be they of a triangle or not
};

void write_mesh_record(const std::filesystem::path& path, Hash128 key, const MeshRecord& record);
// DamagedArtifact when it fails its checks or has another key than one that is given, StorageError
// when it cannot be read.
MeshRecord read_mesh_record(const std::filesystem::path& path, std::optional<Hash128> key = {});

// Of a brick or a shard. `reached`: by a triangle at least.
enum class MeshSide : std::uint8_t { outside, inside, reached };

class MeshBinsWriter {
 public:
  MeshBinsWriter(const std::filesystem::path& path, Hash128 key);
  void bin(std::uint64_t brick, const MeshBin& bin);
  // bricks: of the shard, those with a bin `reached`.
  void commit(std::span<const MeshSide> bricks);

 private:
  ArtifactWriter file_;
};

// Thread-safe. DamagedArtifact when something fails its checks, StorageError when it cannot be
// read.
class MeshBins : public OpenArtifact {
 public:
  explicit MeshBins(const std::filesystem::path& path);

  std::span<const MeshSide> bricks() const { return bricks_; }
  std::uint64_t triangles(std::uint64_t brick) const;
  // Precondition: bricks()[brick] is `reached`. samples: how many, for the size of its parts.
  MeshBin read(std::uint64_t brick, const Box3& samples) const;

 private:
  std::vector<MeshSide> bricks_;
};

struct MeshTableFacts {
  std::uint64_t bricks = 0;     // that triangles reach
  std::uint64_t triangles = 0;  // in all bins: one may be in several
  std::uint64_t largest = 0;    // of the bins, in triangles
  Index3 largest_brick;
};

struct MeshTable {
  MeshTableFacts facts;
  std::vector<MeshSide> shards;
};

void write_mesh_table(const std::filesystem::path& path, Hash128 key, const MeshTable& table);
// As read_mesh_record.
MeshTable read_mesh_table(const std::filesystem::path& path, std::optional<Hash128> key = {});

}  // namespace voxweld
