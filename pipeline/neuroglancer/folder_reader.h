// What an export has written, read as clients do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/neuroglancer/object_store.h"
#include "stages/encode/fragment_codec.h"
#include "stages/encode/fragment_index.h"
#include "storage/support/file_io.h"

namespace voxweld {

struct ExportedObject {
  std::uint64_t id = 0;
  std::filesystem::path data;  // the file that has the fragments
  std::uint64_t offset = 0;    // of the first of them
  FragmentIndex index;
};

struct LegacyMesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

class FolderReader {
 public:
  // InputError where the folder has no `info` of an export by voxweld, FormatError where that is not what
  // it should be.
  explicit FolderReader(std::filesystem::path folder);

  bool legacy() const { return legacy_; }
  bool open_border() const { return open_border_; }
  const std::optional<Sharding>& sharding() const { return sharding_; }
  const std::vector<std::uint64_t>& ids() const { return ids_; }  // ascending

  // FormatError for what is damaged, StorageError for what is missing. Precondition: one of ids().
  ExportedObject object(std::uint64_t id) const;
  FragmentMesh fragment(const ExportedObject& object, const FragmentEntry& entry,
                        std::uint64_t offset) const;
  // Of the old format: names of an object's fragments, and one of them.
  std::vector<std::string> legacy_names(std::uint64_t id) const;
  LegacyMesh legacy_fragment(const std::string& name) const;

 private:
  struct Place {
    std::filesystem::path file;
    std::uint64_t offset = 0, size = 0;
  };
  void find_files();
  void find_shards();
  void read_shard(const std::filesystem::path& path);

  std::filesystem::path folder_;
  bool legacy_ = false, open_border_ = false;
  std::optional<Sharding> sharding_;
  std::vector<std::uint64_t> ids_;
  std::map<std::uint64_t, Place> manifests_;  // of shards
};

// Whether a folder is an export, and not an output directory.
bool is_export_folder(const std::filesystem::path& folder);

}  // namespace voxweld
