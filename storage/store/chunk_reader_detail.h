// What the two sources of ChunkReader share: boxes of samples (chunk_reader.cpp), and the files,
// indexes and headers that they are found by (chunk_files.cpp).
#pragma once

#include "storage/store/chunk_reader.h"

namespace voxweld {

// More than any codec makes of one byte: what says it is larger is not worth its memory.
inline constexpr std::uint64_t best_chunk_ratio = std::uint64_t{1} << 17;

struct ChunkReader::Piece {
  Index3 at;      // in the grid of its level
  Encoded bytes;  // no object: the file is missing
  std::vector<ShardIndexEntry> index;
};

struct ChunkReader::Buffers {
  std::vector<std::byte> encoded, scratch;
  DecodedChunk chunk;
};

// Files, and pieces of each level, whose indexes are held. object_memory: of an open file.
std::size_t pieces_to_cache(const ZarrArray& array, std::uint64_t object_memory);
std::uint64_t decoded_bytes(const ZarrArray& array);       // of a chunk, as it is kept
std::uint64_t block_header_bytes(const ZarrArray& array);  // the longest

}  // namespace voxweld
