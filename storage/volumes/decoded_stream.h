// Stored bytes of a file, decoded from the first to the last in a small constant of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "storage/support/file_io.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

class DecodedStream {
 public:
  virtual ~DecodedStream() = default;
  // Decodes into `out`; returns the bytes written, fewer than asked only at the end of the stream,
  // whose checksum, where it has one, has been verified then. FormatError for corrupt or truncated
  // data.
  virtual std::size_t read_some(std::span<std::byte> out) = 0;
  virtual std::uint64_t decoded() const = 0;  // bytes so far
};

// More than any of the decoders holds.
inline constexpr std::uint64_t decoder_memory_bytes = std::uint64_t{4} << 20;

// True for the first bytes of a bzip2 stream.
bool looks_bzip2(std::span<const std::byte> head);

// Of the layout's encoding, which is deflated, bzip2 or byte_rle, and of one of its parts. The file
// must outlive the stream.
std::unique_ptr<DecodedStream> open_decoded(DataEncoding encoding, const ReadFile& file,
                                            const DataLayout::Part& part);

}  // namespace voxweld
