// Where a brick store lies and how it is cut. The store is a Zarr v3 array, sharded, that any Zarr
// reader opens; beside each shard lies a record of ours (shard_record.h).
//
//   <array>/zarr.json        written first
//   <array>/c/K/J/I          shard (I, J, K), Zarr's own key of it
//   <records>/K/J/I.shard    its record, renamed into place last
#pragma once

#include <cstdint>
#include <filesystem>

#include "storage/store/zarr_metadata.h"
#include "storage/types/box.h"
#include "storage/types/volume.h"

namespace voxweld {

enum class StoreCompression : std::uint8_t {
  lz4,   // blosc: byte shuffle, lz4
  zstd,  // blosc: byte shuffle, zstd
  none,
};

struct StoreParameters {
  std::int64_t chunk = 32;   // samples a side of an inner chunk: what is decoded at once
  std::int64_t shard = 256;  // samples a side of a file, a multiple of chunk
  StoreCompression compression = StoreCompression::lz4;
  int level = 5;  // of the compression, 0 to 9
};

struct StoreLayout {
  std::filesystem::path array;
  std::filesystem::path records;  // default_records_directory(array), or any other
  SampleType type = SampleType::u8;
  VolumeGeometry geometry;
  StoreParameters parameters;
  ValueScale scale = {};  // of the samples, which are as the input stores them

  Index3 shard_grid() const;    // shards a side
  std::int64_t chunks() const;  // inner chunks a side of a shard
  // The samples of the volume in a shard: less than a whole cube at the upper borders.
  Box3 shard_samples(Index3 shard) const;
  std::filesystem::path shard_path(Index3 shard) const;
  std::filesystem::path record_path(Index3 shard) const;
  ZarrArray zarr() const;
};

std::filesystem::path default_records_directory(const std::filesystem::path& array);

// Throws InputError where the sizes or the geometry make no store.
void check_layout(const StoreLayout& layout);

// Checks the layout and writes its zarr.json.
void write_store_metadata(const StoreLayout& layout);

// Whether it is there, as this layout is written.
bool store_metadata_is_current(const StoreLayout& layout);

// The layout of an existing store. DamagedArtifact where its zarr.json is not as it was written,
// FormatError where the array is not a store of ours.
StoreLayout read_store_layout(const std::filesystem::path& array,
                              const std::filesystem::path& records);

}  // namespace voxweld
