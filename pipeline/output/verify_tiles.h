// Tiles of an output directory, read and checked one by one: what verify does on many threads.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/output/intersection_check.h"
#include "pipeline/output/tile_check.h"
#include "pipeline/output/verify.h"
#include "stages/encode/mesh_measure.h"
#include "stages/encode/mesh_writers.h"

namespace voxweld {

using Problems = std::vector<Problem>;

// One file, checked against its record. Empty when it cannot be read.
std::vector<std::byte> checked_file(const std::filesystem::path& directory,
                                    const FileRecord& record, Problems& problems);
// The same without holding it.
void check_file(const std::filesystem::path& directory, const FileRecord& record,
                Problems& problems);

// One mesh's file in one format.
struct FormatFile {
  const MeshWriter* format = nullptr;
  std::string path;
  std::vector<std::byte> bytes;  // empty: could not be read, which was said
};
// The mesh of the first file that decodes; those of the others must have the same triangles.
std::optional<LatticeMesh> decode(const std::vector<FormatFile>& files,
                                  const OutputLattice& lattice, Problems& problems);

// How messages call a listed tile: "tile 5/1,0,2", "label 7 tile 5/1,0,2".
std::string record_name(const TileRecord& record);

struct TileResult {
  TileRecord record;
  Problems problems;
  TileSeams seams;
  TriangleDigest triangles;
  MeshMeasure measure;              // of tiles of a label
  TileIntersections intersections;  // where asked for
  std::uint64_t files = 0, bytes = 0;
};

struct TileChecks {
  bool intersections = false;
  bool vertices_listed = true;  // by the tile's own record
  bool by_label = false;        // with labels.mode = "each": seams as between labels
};

class TileReader {
 public:
  // All outlive it.
  TileReader(const std::filesystem::path& directory, const Manifest& manifest, MeshWriters formats)
      : directory_(directory), manifest_(manifest), formats_(formats), frame_(manifest) {}

  TileResult check(TileRecord record, const TileChecks& checks) const;
  // Those of `points` that the tile has: each is surrounded in it and used by another tile too.
  Problems use_of(const TileRecord& record, const std::vector<LatticePoint>& points) const;
  // Its mesh once more, without a word of what is wrong with it. Empty when it cannot be read.
  LatticeMesh mesh_again(const TileRecord& record) const;

 private:
  std::optional<LatticeMesh> read(TileResult& result) const;
  void check_mesh(LatticeMesh& mesh, const TileChecks& checks, TileResult& result) const;

  const std::filesystem::path& directory_;
  const Manifest& manifest_;
  const MeshWriters formats_;
  const PointFrame frame_;
};

}  // namespace voxweld
