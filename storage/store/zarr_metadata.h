// The metadata of one Zarr array (zarr.json of version 3, .zarray of version 2), and where the
// array's chunks lie.
// Specifications: "Zarr core specification, version 3.0", with the codecs bytes, blosc, zstd, gzip,
// crc32c, transpose and sharding_indexed; "Zarr storage specification, version 2", with the
// compressors blosc, zlib, gzip, bz2, zstd and lz4 and no filters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/store/codec.h"
#include "storage/types/box.h"
#include "storage/types/sample_type.h"
#include "storage/types/volume.h"

namespace voxweld {

struct OmeDataset;

// How the index of a sharding_indexed file is stored.
struct ShardIndexForm {
  bool at_end = true;
  bool big_endian = false;
  int checksums = 1;  // crc32c codecs over it
};

// An entry of that index: where a chunk lies in its file. All bits are set where it is missing.
struct ShardIndexEntry {
  static constexpr std::uint64_t missing = ~std::uint64_t{0};
  std::uint64_t offset = missing, length = missing;
};

// All extents are x, y, z. A two-dimensional array is a volume of one slice.
struct ZarrArray {
  std::filesystem::path path;  // the array's directory, which holds the metadata
  const char* metadata = "zarr.json";
  std::vector<int> axes{2, 1, 0};  // which of x, y, z (0, 1, 2) each of Zarr's dimensions is
  SampleType type = SampleType::u8;
  Index3 size;   // samples a side
  Index3 file;   // samples a side that one file holds (the chunk grid)
  Index3 chunk;  // samples a side of what is encoded as one piece; divides `file`
  std::array<int, 3> order{0, 1, 2};  // the axes of a chunk's samples, the fastest first
  bool sharded = false;
  ShardIndexForm index;
  CodecChain codecs;
  bool v2_keys = false;  // chunk keys without the leading "c"
  char separator = '/';
  std::array<std::byte, 8> fill{};  // one sample, native byte order

  // Set where the attributes hold voxweld's own description, or a group above is an OME-Zarr image.
  std::optional<VolumeGeometry> geometry;
  ValueScale scale;

  ChunkForm form() const;
  Index3 chunks_in_file() const;
  std::uint64_t index_bytes() const;  // on disk, checksums included
  double files() const;               // as many as there are, or might be
  std::filesystem::path file_path(Index3 file_index) const;
};

// Whether there is an array's metadata in the directory.
bool holds_zarr_array(const std::filesystem::path& directory);
// Throws InputError where `directory` is no directory or holds no Zarr array, FormatError where it
// is of a version, type, rank or codec that is not supported, naming it. image: what an OME-Zarr group above says of the array, if there is one.
ZarrArray read_zarr_array(const std::filesystem::path& directory,
                          const OmeDataset* image = nullptr);

// The same from the text of a zarr.json. `directory` is for the messages and for file_path.
ZarrArray parse_zarr_array(const std::string& text, const std::filesystem::path& directory,
                           const OmeDataset* image = nullptr);
// The same from the text of a .zarray.
ZarrArray parse_zarr_v2_array(const std::string& text, const std::filesystem::path& directory,
                              const OmeDataset* image = nullptr);

// The text of zarr.json: the same for the same array. Arrays with one compressor, little-endian,
// default keys only. `geometry` goes into the attributes, with a checksum over the whole document.
std::string render_zarr_array(const ZarrArray& array);

}  // namespace voxweld
