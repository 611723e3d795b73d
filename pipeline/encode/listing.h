// The end of encode: tiles.jsonl, of labels labels.jsonl, and manifest.json from the records of the
// assets, one at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "storage/artifact/asset_record.h"
#include "storage/manifest/manifest.h"
#include "storage/support/file_names.h"
#include "storage/types/material_table.h"

namespace voxweld {

struct ListedTile {
  CellKey tile;                  // not looked at where the record is of labels
  std::filesystem::path record;  // storage/artifact/asset_record.h
};

// DamagedArtifact where it is not one.
AssetRecord whole_record(const std::filesystem::path& path);

struct Listing {
  std::vector<ListedTile> tiles;
  const MaterialTable* materials = nullptr;  // names and colours of labels, where there are some
  // each: the records are of labels, those of one together, and they ascend. shared: every record
  // may be of any.
  LabelMode labels = LabelMode::off;
  bool normals = false;                         // the meshes have some
  std::optional<std::filesystem::path> merged;  // the merged mesh's record, where there is one
  std::filesystem::path output;
  std::filesystem::path scratch;  // a folder for what does not fit memory
  // Where there are such: the place of a mesh (TileRecord), by the number of the tile and its own in that.
  std::function<std::optional<CellKey>(std::size_t, std::size_t)> place = {};
  // Of coarser levels: adds their files and section to the manifest.
  std::function<void(Manifest&, FileNames&)> levels = {};
  const InterruptFlag* interrupt = nullptr;  // asked between records; the manifest comes last

  void check_interrupt() const {
    if (interrupt != nullptr) interrupt->check();
  }
};

// Writes the lists and then the manifest, with counts and files filled in; removes those of the
// `earlier` files that are not in it, and takes the others out of them. DamagedArtifact where a
// record is not whole, Interrupted where a stop was asked for.
void write_listing(const Listing& listing, FileNames& earlier, Manifest manifest);

}  // namespace voxweld
