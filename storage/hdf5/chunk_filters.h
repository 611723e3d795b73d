// Decoding the chunks of a dataset without libhdf5, which does one thing at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/hdf5/hdf5_dataset.h"

namespace voxweld {

// That all of them are filters that decode_stored_chunk knows: deflate, shuffle, fletcher32, lzf,
// blosc, lz4, zstd and bitshuffle; of those that compress one at most.
bool decodes_chunks(const std::vector<StoredFilter>& filters);

// Fills `samples` from the bytes of one chunk. mask: bit i says that filter i was left out. Returns
// what is wrong with it, or an empty text. Precondition: decodes_chunks(filters).
std::string decode_stored_chunk(const std::vector<StoredFilter>& filters, std::uint32_t mask,
                                std::span<const std::byte> stored, std::span<std::byte> samples);

// LZF: runs of bytes and copies of what came before. What is wrong, or an empty text.
std::string decode_lzf(std::span<const std::byte> stored, std::span<std::byte> out);

// The checksum behind the data of a chunk, as libhdf5 takes it.
std::uint32_t fletcher32(std::span<const std::byte> data);

}  // namespace voxweld
