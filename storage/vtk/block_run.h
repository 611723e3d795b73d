// Arrays of VTK's XML files as its compressors write them: blocks of equal size, each compressed by
// itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/vtk/byte_run.h"

namespace voxweld {

enum class BlockCodec : std::uint8_t { zlib, lz4, lzma };

// Sizes in decoded bytes, and where the blocks lie.
struct BlockTable {
  std::uint64_t block_bytes = 0;      // of each block but the last
  std::uint64_t total = 0;            // of all
  std::vector<std::uint64_t> starts;  // of the compressed blocks in their run, and of its end
};

// How the words of a header in front of the data are stored.
struct WordForm {
  std::size_t bytes = 4;  // or 8
  std::endian order = std::endian::little;
};

// The table that stands first in the run: number of blocks, their size, that of a last shorter one
// or 0, and the compressed size of each. where: for messages.
// FormatError unless the blocks are `needed` bytes in all, fit the stored bytes, and are small
// enough to be decoded whole (64 MiB).
BlockTable read_block_table(const ByteRun& run, WordForm form, std::uint64_t needed,
                            BlockCodec codec, const std::string& where);
// Bytes of the table itself.
inline std::uint64_t block_table_bytes(const BlockTable& table, WordForm form) {
  return (3 + table.starts.size() - 1) * form.bytes;
}

struct OpenedBlocks {
  std::unique_ptr<ByteRun> run;
  std::uint64_t memory = 0;  // bytes a call of read() holds, cached blocks included
};
// The decoded bytes. compressed: what table.starts count in.
OpenedBlocks open_blocks(std::unique_ptr<ByteRun> compressed, BlockTable table, BlockCodec codec,
                         const std::string& where);

}  // namespace voxweld
