// tiles.pvtp: the .vtp tiles of an output as one mesh, for ParaView and all that is made with VTK.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "storage/artifact/asset_record.h"

namespace voxweld {

// What all tiles have.
struct PieceArrays {
  bool normals = false;
  bool between_labels = false;
};

// Written piece by piece. Where no tile has a .vtp there is no file.
class PieceList {
 public:
  // output: outlives it.
  PieceList(const std::filesystem::path& output, const PieceArrays& arrays)
      : output_(output), arrays_(arrays) {}

  // The next tile's record. Its labels say what type of numbers its .vtp has for them.
  void add(const AssetRecord& record);
  // A list has one type for all its pieces. So there is none, with a warning, where labels of some tiles
  // need 64 bits and those of others do not.
  std::optional<FileRecord> finish();

 private:
  const std::filesystem::path& output_;
  const PieceArrays arrays_;
  std::optional<AssetFile> file_;
  bool narrow_ = false, wide_ = false;  // types of labels seen
};

}  // namespace voxweld
