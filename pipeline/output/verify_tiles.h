// Tiles of an output directory, read and checked one by one: what verify does on many threads.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/output/tile_check.h"
#include "pipeline/output/verify.h"
#include "stages/encode/mesh_measure.h"

namespace voxweld {

using Problems = std::vector<Problem>;

// One file, checked against its record. Empty when it cannot be read.
std::vector<std::byte> checked_file(const std::filesystem::path& directory,
                                    const FileRecord& record, Problems& problems);
// The same without holding it.
void check_file(const std::filesystem::path& directory, const FileRecord& record,
                Problems& problems);

// The .drc and the .glb of one mesh hold the same Draco buffer; where they do not, they must at
// least hold the same triangles.
struct MeshFiles {
  std::vector<std::byte> drc, glb;
  std::string drc_path, glb_path;

  std::optional<LatticeMesh> decode(const OutputLattice& lattice, Problems& problems) const;
};

// How messages call a listed tile: "tile 5/1,0,2", "label 7 tile 5/1,0,2".
std::string record_name(const TileRecord& record);

struct TileResult {
  TileRecord record;
  Problems problems;
  TileSeams seams;
  TriangleDigest triangles;
  MeshMeasure measure;  // of tiles of a label
  std::uint64_t files = 0, bytes = 0;
};

class TileReader {
 public:
  // Both outlive it.
  TileReader(const std::filesystem::path& directory, const Manifest& manifest)
      : directory_(directory), manifest_(manifest), frame_(manifest) {}

  TileResult check(TileRecord record) const;
  // Those of `points` that the tile has: each is surrounded in it and used by another tile too.
  Problems use_of(const TileRecord& record, const std::vector<LatticePoint>& points) const;

 private:
  std::optional<LatticeMesh> read(TileResult& result) const;
  void check_mesh(LatticeMesh& mesh, TileResult& result) const;

  const std::filesystem::path& directory_;
  const Manifest& manifest_;
  const PointFrame frame_;
};

}  // namespace voxweld
