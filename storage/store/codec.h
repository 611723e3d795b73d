// The codecs of one Zarr chunk: samples <-> the bytes on disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace voxweld {

enum class CompressorKind : std::uint8_t {
  blosc,
  zstd,
  gzip,  // and zlib
  bz2,
  lz4,         // numcodecs': the size, and one block
  lz4_blocks,  // lz4-java's stream
  xz,          // and .lzma
};
// The name that voxweld shows: "gzip".
const char* compressor_name(CompressorKind kind);
enum class Shuffle : std::uint8_t { none = 0, byte = 1, bit = 2 };  // blosc's own numbers

struct Compressor {
  CompressorKind kind = CompressorKind::blosc;
  std::string cname = "lz4";  // blosc's inner codec
  int level = 5;
  Shuffle shuffle = Shuffle::byte;  // blosc
};

// Zarr's "bytes", at most one compressor, and crc32c checksums before and after it, in the order
// of encoding.
struct CodecChain {
  bool big_endian = false;
  int checksums_inside = 0;   // taken over what goes into the compressor
  int checksums_outside = 0;  // taken over what comes out of it
  std::optional<Compressor> compressor;
};

// The samples of a chunk: `bytes` a multiple of `sample_bytes`.
struct ChunkForm {
  std::size_t bytes = 0;
  std::size_t sample_bytes = 1;
};

// More bytes than this no encoder makes of a chunk: a larger length on disk is damage, and must
// not be allocated.
std::uint64_t largest_encoded_chunk(const CodecChain& chain, ChunkForm form);

// Replaces `encoded` by the encoded chunk. Writes little-endian chains of blosc, zstd or no
// compressor only. The same samples give the same bytes in every process.
// Preconditions: samples.size() == form.bytes <= 2^30; !chain.big_endian; blosc or zstd.
void encode_chunk(const CodecChain& chain, ChunkForm form, std::span<const std::byte> samples,
                  std::vector<std::byte>& encoded);

// Fills `samples` (form.bytes long, native byte order) from the encoded chunk. Returns what is
// wrong with it, or an empty text. `scratch` is the caller's, to be reused.
std::string decode_chunk(const CodecChain& chain, ChunkForm form,
                         std::span<const std::byte> encoded, std::span<std::byte> samples,
                         std::vector<std::byte>& scratch);

// Takes the four bytes of a crc32c off the end of `data`; what is wrong, or an empty text.
std::string strip_checksum(std::span<const std::byte>& data);
void append_checksum(std::vector<std::byte>& data);

}  // namespace voxweld
