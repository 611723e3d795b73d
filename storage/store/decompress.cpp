#include "storage/store/decompress.h"

#include <blosc.h>
#include <bzlib.h>
#include <fmt/format.h>
#include <lzma.h>
#include <xxhash.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <tuple>

#include "storage/support/byte_order.h"
#include "storage/support/lz4_block.h"

namespace voxweld {
namespace {

std::string blosc_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  std::size_t size = 0;
  if (blosc_cbuffer_validate(encoded.data(), encoded.size(), &size) != 0)
    return "its blosc header does not fit its length";
  if (size != out.size()) return fmt::format("blosc holds {} bytes, {} expected", size, out.size());
  const int got = blosc_decompress_ctx(encoded.data(), out.data(), out.size(), 1);
  if (got < 0 || static_cast<std::size_t>(got) != out.size()) {
    const char* inner = blosc_cbuffer_complib(encoded.data());
    return fmt::format("blosc cannot decode it (inner codec {})", inner != nullptr ? inner : "?");
  }
  return {};
}

std::string zstd_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  const std::size_t got = ZSTD_decompress(out.data(), out.size(), encoded.data(), encoded.size());
  if (ZSTD_isError(got) != 0) return fmt::format("zstd: {}", ZSTD_getErrorName(got));
  if (got != out.size()) return fmt::format("zstd holds {} bytes, {} expected", got, out.size());
  return {};
}

// zlib counts in 32 bits: long buffers go through it in windows.
class Inflater {
 public:
  Inflater(std::span<const std::byte> in, std::span<std::byte> out, bool bare)
      : in_(in), out_(out) {
    ready_ = inflateInit2(&stream_, bare ? -15 : 15 + 32) == Z_OK;  // 32: gzip's or zlib's header
  }
  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  std::string run() {
    if (!ready_) return "gzip: out of memory";
    for (;;) {
      const int code = step();
      if (code == Z_STREAM_END) {
        if (in_.empty()) break;
        if (inflateReset(&stream_) != Z_OK) return "gzip: cannot go on with its next member";
        continue;
      }
      if (code == Z_BUF_ERROR || (code == Z_OK && stuck_))
        return out_.empty() ? "gzip holds more bytes than expected" : "gzip: truncated";
      if (code != Z_OK)
        return fmt::format("gzip: {}", stream_.msg != nullptr ? stream_.msg : "damaged");
    }
    return out_.empty() ? "" : fmt::format("gzip ends {} bytes short", out_.size());
  }

 private:
  int step() {
    constexpr std::size_t window = std::size_t{1} << 30;
    // zlib never writes through next_in; its type predates const.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in_.data()));
    stream_.avail_in = static_cast<uInt>(std::min(in_.size(), window));
    stream_.next_out = reinterpret_cast<Bytef*>(out_.data());
    stream_.avail_out = static_cast<uInt>(std::min(out_.size(), window));
    const uInt in_before = stream_.avail_in, out_before = stream_.avail_out;
    const int code = inflate(&stream_, Z_NO_FLUSH);
    stuck_ = in_before == stream_.avail_in && out_before == stream_.avail_out;
    in_ = in_.subspan(in_before - stream_.avail_in);
    out_ = out_.subspan(out_before - stream_.avail_out);
    return code;
  }

  std::span<const std::byte> in_;
  std::span<std::byte> out_;
  z_stream stream_{};
  bool ready_ = false;
  bool stuck_ = false;
};

// numcodecs': the decoded size in four bytes, little-endian, and one block.
std::string lz4_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  constexpr std::size_t size_bytes = 4;
  if (encoded.size() < size_bytes) return "lz4: truncated";
  std::uint32_t size = 0;
  std::memcpy(&size, encoded.data(), size_bytes);
  to_native(reinterpret_cast<std::byte*>(&size), 1, size_bytes, std::endian::little);
  if (size != out.size()) return fmt::format("lz4 holds {} bytes, {} expected", size, out.size());
  const auto block = encoded.subspan(size_bytes);
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (block.size() > most || out.size() > most) return "lz4: more than 2^31 bytes in one block";
  if (!lz4_decode_block(block, out)) return "lz4: damaged";
  return {};
}

std::string bz2_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  constexpr std::size_t most = std::numeric_limits<unsigned>::max();
  if (encoded.size() > most || out.size() > most) return "bz2: more than 2^32 bytes in one chunk";
  auto size = static_cast<unsigned>(out.size());
  // Its types predate const.
  auto* in = const_cast<char*>(reinterpret_cast<const char*>(encoded.data()));
  const int code = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &size, in,
                                              static_cast<unsigned>(encoded.size()), 0, 0);
  if (code == BZ_OUTBUFF_FULL) return "bz2 holds more bytes than expected";
  if (code == BZ_UNEXPECTED_EOF) return "bz2: truncated";
  if (code != BZ_OK) return fmt::format("bz2: damaged (error {})", code);
  return size == out.size() ? "" : fmt::format("bz2 ends {} bytes short", out.size() - size);
}

// The stream that lz4-java writes: blocks, each behind a header of 21 bytes, the last one empty.
//   "LZ4Block", token (0x10: as it is, 0x20: lz4; below it the size of blocks), encoded size u32,
//   decoded size u32, XXH32 of what is decoded, of which 28 bits are kept; little-endian
std::string lz4_blocks_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  constexpr std::size_t header_bytes = 21, most = std::size_t{1} << 25;
  constexpr std::uint32_t seed = 0x9747b28c, kept_bits = 0x0fffffff;
  while (!encoded.empty()) {
    if (encoded.size() < header_bytes) return "lz4: truncated";
    if (std::memcmp(encoded.data(), "LZ4Block", 8) != 0) return "lz4: \"LZ4Block\" expected";
    std::uint32_t fields[3];
    std::memcpy(fields, encoded.data() + 9, sizeof fields);
    to_native(reinterpret_cast<std::byte*>(fields), 3, 4, std::endian::little);
    const auto [packed, size, checksum] = std::tuple(fields[0], fields[1], fields[2]);
    const unsigned method = std::to_integer<unsigned>(encoded[8]) & 0xf0;
    encoded = encoded.subspan(header_bytes);
    if (size == 0 && packed == 0) break;
    if (size > out.size()) return "lz4 holds more bytes than expected";
    if (packed > encoded.size()) return "lz4: truncated";
    if (size > most || (method == 0x10 && size != packed) || (method != 0x10 && method != 0x20))
      return "lz4: the header of a block is damaged";
    const auto block = encoded.first(packed);
    if (method == 0x10)
      std::memcpy(out.data(), block.data(), size);
    else if (!lz4_decode_block(block, out.first(size)))
      return "lz4: damaged";
    if ((XXH32(out.data(), size, seed) & kept_bits) != checksum) return "lz4: wrong checksum";
    encoded = encoded.subspan(packed);
    out = out.subspan(size);
  }
  return out.empty() ? "" : fmt::format("lz4 ends {} bytes short", out.size());
}

// xz, or the older .lzma.
std::string xz_decode(std::span<const std::byte> encoded, std::span<std::byte> out) {
  // A header's dictionary is memory that is asked for at once, though touched as far as there are
  // samples only. More than the largest preset asks for, and more than twice what there is to
  // decode, is damage.
  constexpr std::uint64_t largest_preset = std::uint64_t{80} << 20;
  const std::uint64_t most_memory = std::max<std::uint64_t>(largest_preset, 2 * out.size());
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_auto_decoder(&stream, most_memory, 0) != LZMA_OK) return "xz: out of memory";
  stream.next_in = reinterpret_cast<const std::uint8_t*>(encoded.data());
  stream.avail_in = encoded.size();
  stream.next_out = reinterpret_cast<std::uint8_t*>(out.data());
  stream.avail_out = out.size();
  const lzma_ret code = lzma_code(&stream, LZMA_FINISH);
  const std::size_t missing = stream.avail_out;
  const std::uint64_t asked = lzma_memusage(&stream);
  lzma_end(&stream);
  if (code == LZMA_MEMLIMIT_ERROR)
    return fmt::format("xz: its header asks for {} bytes of memory for {} bytes, {} are given",
                       asked, out.size(), most_memory);
  if (code == LZMA_BUF_ERROR || code == LZMA_OK)
    return missing == 0 ? "xz holds more bytes than expected" : "xz: truncated";
  if (code != LZMA_STREAM_END) return fmt::format("xz: damaged (error {})", static_cast<int>(code));
  return missing == 0 ? "" : fmt::format("xz ends {} bytes short", missing);
}

}  // namespace

std::string decompress(const Compressor& compressor, std::span<const std::byte> encoded,
                       std::span<std::byte> out) {
  switch (compressor.kind) {
    case CompressorKind::blosc:
      return blosc_decode(encoded, out);
    case CompressorKind::zstd:
      return zstd_decode(encoded, out);
    case CompressorKind::bz2:
      return bz2_decode(encoded, out);
    case CompressorKind::lz4:
      return lz4_decode(encoded, out);
    case CompressorKind::lz4_blocks:
      return lz4_blocks_decode(encoded, out);
    case CompressorKind::xz:
      return xz_decode(encoded, out);
    case CompressorKind::gzip:
      break;
  }
  return inflate_all(encoded, out, false);
}

std::string inflate_all(std::span<const std::byte> encoded, std::span<std::byte> out, bool bare) {
  return Inflater(encoded, out, bare).run();
}

}  // namespace voxweld
