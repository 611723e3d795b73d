// The sidecar of an output asset: what it was made from and what its files are. Written after them,
// so files without a record, or other than it says, are not taken for whole.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/types/file_record.h"
#include "storage/types/lattice_box.h"
#include "storage/types/material.h"
#include "storage/types/mesh_measure.h"

namespace voxweld {

// One mesh of several that one record is of: a label's, or one tile of it. Between labels (shared):
// a label's boundary in the tile, all of them in the tile's files.
struct LabelAsset {
  Material label = exterior;
  CellKey tile;
  std::uint64_t octree_vertices = 0;  // that lie in the tile
  std::uint64_t vertices = 0, triangles = 0, quads = 0, polygon_triangles = 0;
  MeshMeasure measure;
  std::size_t files = 0;  // how many of the record's, in their order, are its
};

struct AssetRecord {
  Hash128 key;
  std::uint64_t vertices = 0, triangles = 0, quads = 0, polygon_triangles = 0, collinear = 0;
  std::vector<FileRecord> files;   // paths relative to the output directory
  std::vector<LabelAsset> labels;  // of label volumes; the counts above are of all of them
  std::optional<LatticeBox> box;   // around its vertices, where it has some
  Hash128 files_stamp;             // as read: of their sizes and times when they were last compared
};

// Precondition: the files it names are in place.
void write_asset_record(const std::filesystem::path& path, const AssetRecord& record,
                        const std::filesystem::path& output);
enum class RecordParts { all, files };  // files: without labels
// Nothing when it is missing or fails its checks.
std::optional<AssetRecord> read_asset_record(const std::filesystem::path& path,
                                             RecordParts parts = RecordParts::all);
// Its key is this one and its files are there, byte for byte: as far as their sizes and times tell,
// else by their hashes, and then the record says so from now on.
bool asset_is_current(const std::filesystem::path& record, Hash128 key,
                      const std::filesystem::path& output);

// One asset file under way; without finish() there is none. `name` is relative to `output`.
class AssetFile {
 public:
  AssetFile(const std::filesystem::path& output, const std::string& name)
      : name_(name), file_(output / name) {}

  void append(std::span<const std::byte> bytes);
  // In place, fsynced; its record.
  FileRecord finish(const std::string& format);

 private:
  std::string name_;
  AtomicFile file_;
  StreamHasher hash_;
};

}  // namespace voxweld
