// What the metadata of one array say (zarr.json of Zarr 3, .zarray of Zarr 2, attributes.json of N5),
// and where the array's chunks lie.
// Specifications: "Zarr core specification, version 3.0", with the codecs bytes, blosc, zstd, gzip,
// crc32c, transpose and sharding_indexed; "Zarr storage specification, version 2", without filters;
// "N5", README of saalfeldlab/n5.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/store/byte_store.h"
#include "storage/store/codec.h"
#include "storage/types/box.h"
#include "storage/types/input_selection.h"
#include "storage/types/sample_type.h"
#include "storage/types/volume.h"

namespace voxweld {

// Of each dimension of an array as it is stored, slowest first.
using Extents = std::vector<std::int64_t>;

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

// How a piece is cut into smaller ones: a sharding_indexed codec.
struct ShardForm {
  Extents chunk;           // samples a side of the smaller ones; divides those of the piece
  std::vector<int> order;  // the dimensions as the index counts them, slowest first
  ShardIndexForm index;
};

// How objects are named after their place in the grid of files.
struct ChunkKeys {
  bool leading_c = true;       // "c/0/1/2"
  bool fastest_first = false;  // as N5 has it
  char separator = '/';
};

struct ZarrArray {
  std::filesystem::path path;  // the array's directory, which holds the metadata
  const char* metadata = "zarr.json";
  std::vector<int> axes{2, 1, 0};  // which of x, y, z (0, 1, 2) each dimension is; -1: none
  Extents at{0, 0, 0};             // of those that are none: the index that is read
  SampleType type = SampleType::u8;
  bool half = false;  // stored as 16-bit floats, and widened; type is f32
  Index3 size;        // samples a side
  Extents file;       // samples a side that one file holds (the chunk grid)
  Extents chunk;      // samples a side of what is encoded as one piece
  std::vector<ShardForm>
      shards;  // how files are cut into chunks, outermost first; none: not at all
  std::vector<int> order{2, 1, 0};  // the dimensions of a chunk's samples, the fastest first
  bool n5_blocks = false;           // each chunk has a header of N5
  CodecChain codecs;
  ChunkKeys keys;
  std::array<std::byte, 8> fill{};  // one sample, native byte order

  // Set where the attributes hold voxweld's own description, or a group above is an image.
  std::optional<VolumeGeometry> geometry;
  ValueScale scale;
  std::vector<InputChoice> choices;  // channels and times
  std::vector<std::string> warnings;

  // x, y, z of extents; 1 where no dimension is that axis.
  Index3 axes_of(const Extents& extents) const;
  std::size_t stored_bytes() const;  // of one sample
  ChunkForm form() const;            // of a chunk as it is stored
  // Of all samples of the file (0) or of a piece of shards[level - 1]; x, y, z by axes_of.
  const Extents& piece(std::size_t level) const;
  // Pieces that one of that level is cut into, of each dimension.
  Extents pieces_in(std::size_t level) const;
  std::uint64_t index_bytes(std::size_t level) const;  // on disk, checksums included
  double files() const;                                // as many as there are, or might be
  std::string file_key(Index3 file_index) const;       // within the array's directory
  std::filesystem::path file_path(Index3 file_index) const;
};

// What is known of an array from outside: what the user chose, and what an image above says of it.
// Of each dimension, slowest first; empty: not said.
struct ArrayContext {
  InputSelection select{};
  bool survey = false;                                // InputSpec::survey
  std::vector<std::string> axes{}, types{}, units{};  // "z", "space", "micrometer"
  std::vector<double> scale{}, translation{};
  std::vector<std::string> channels{};  // their names
  std::string where{};                  // who says so, for messages
};

// Whether there is an array's metadata in the directory.
bool holds_zarr_array(const std::filesystem::path& directory);
// Throws InputError where the folder is none or holds no Zarr array, FormatError where it is of a
// version, type, rank or codec that is not supported, naming it.
ZarrArray read_zarr_array(const std::filesystem::path& directory);
ZarrArray read_zarr_array(const StoreFolder& folder, const ArrayContext& context);

// The same from the text of a zarr.json. `directory` is for the messages and for file_path.
ZarrArray parse_zarr_array(const std::string& text, const std::filesystem::path& directory,
                           const ArrayContext& context = {});
// The same from the text of a .zarray.
ZarrArray parse_zarr_v2_array(const std::string& text, const std::filesystem::path& directory,
                              const ArrayContext& context = {});

// The text of zarr.json: the same for the same array. Arrays with one compressor, little-endian,
// default keys only. `geometry` goes into the attributes, with a checksum over the whole document.
std::string render_zarr_array(const ZarrArray& array);

}  // namespace voxweld
