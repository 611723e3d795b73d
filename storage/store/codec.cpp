#include "storage/store/codec.h"

#include <blosc.h>
#include <bzlib.h>
#include <fmt/format.h>
#include <lz4.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "storage/store/crc32c.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t checksum_bytes = 4;

// How many bytes the compressor was given.
std::size_t inner_bytes(const CodecChain& chain, ChunkForm form) {
  return form.bytes + checksum_bytes * static_cast<std::size_t>(chain.checksums_inside);
}

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
  Inflater(std::span<const std::byte> in, std::span<std::byte> out) : in_(in), out_(out) {
    ready_ = inflateInit2(&stream_, 15 + 32) == Z_OK;  // gzip or zlib header
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
  const int got = LZ4_decompress_safe(reinterpret_cast<const char*>(block.data()),
                                      reinterpret_cast<char*>(out.data()),
                                      static_cast<int>(block.size()), static_cast<int>(out.size()));
  if (got < 0 || static_cast<std::size_t>(got) != out.size()) return "lz4: damaged";
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
    case CompressorKind::gzip:
      break;
  }
  return Inflater(encoded, out).run();
}

void compress(const Compressor& compressor, ChunkForm form, std::span<const std::byte> data,
              std::vector<std::byte>& encoded) {
  if (compressor.kind == CompressorKind::blosc) {
    encoded.resize(data.size() + BLOSC_MAX_OVERHEAD);
    // One thread and a given context: blosc's global state and environment stay out of the bytes.
    const int size = blosc_compress_ctx(compressor.level, static_cast<int>(compressor.shuffle),
                                        form.sample_bytes, data.size(), data.data(), encoded.data(),
                                        encoded.size(), compressor.cname.c_str(), 0, 1);
    if (size <= 0) throw StorageError("blosc cannot compress with " + compressor.cname);
    encoded.resize(static_cast<std::size_t>(size));
    return;
  }
  encoded.resize(ZSTD_compressBound(data.size()));
  const std::size_t size =
      ZSTD_compress(encoded.data(), encoded.size(), data.data(), data.size(), compressor.level);
  if (ZSTD_isError(size) != 0)
    throw StorageError(fmt::format("zstd cannot compress: {}", ZSTD_getErrorName(size)));
  encoded.resize(size);
}

}  // namespace

std::uint64_t largest_encoded_chunk(const CodecChain& chain, ChunkForm form) {
  const std::uint64_t inside = inner_bytes(chain, form);
  const std::uint64_t after =
      chain.compressor ? inside + inside / 4 + (std::uint64_t{1} << 16) : inside;
  return after + checksum_bytes * static_cast<std::uint64_t>(chain.checksums_outside);
}

std::string strip_checksum(std::span<const std::byte>& data) {
  if (data.size() < checksum_bytes) return "too short for its crc32c";
  const auto body = data.first(data.size() - checksum_bytes);
  std::uint32_t stored = 0;
  std::memcpy(&stored, data.data() + body.size(), checksum_bytes);
  const std::uint32_t found = crc32c(body);
  if (found != stored) return fmt::format("crc32c is {:08x}, {:08x} expected", found, stored);
  data = body;
  return {};
}

void append_checksum(std::vector<std::byte>& data) {
  const std::uint32_t crc = crc32c(data);
  data.resize(data.size() + checksum_bytes);
  std::memcpy(data.data() + data.size() - checksum_bytes, &crc, checksum_bytes);
}

void encode_chunk(const CodecChain& chain, ChunkForm form, std::span<const std::byte> samples,
                  std::vector<std::byte>& encoded) {
  if (chain.checksums_inside == 0 && chain.compressor) {
    compress(*chain.compressor, form, samples, encoded);
  } else {
    encoded.assign(samples.begin(), samples.end());
    for (int i = 0; i < chain.checksums_inside; ++i) append_checksum(encoded);
    if (chain.compressor) {
      const std::vector<std::byte> inner = encoded;
      compress(*chain.compressor, form, inner, encoded);
    }
  }
  for (int i = 0; i < chain.checksums_outside; ++i) append_checksum(encoded);
}

std::string decode_chunk(const CodecChain& chain, ChunkForm form,
                         std::span<const std::byte> encoded, std::span<std::byte> samples,
                         std::vector<std::byte>& scratch) {
  for (int i = 0; i < chain.checksums_outside; ++i)
    if (auto wrong = strip_checksum(encoded); !wrong.empty()) return wrong;
  const bool direct = chain.compressor && chain.checksums_inside == 0;
  if (chain.compressor) {
    if (!direct) scratch.resize(inner_bytes(chain, form));
    const std::span<std::byte> out = direct ? samples : std::span(scratch);
    if (auto wrong = decompress(*chain.compressor, encoded, out); !wrong.empty()) return wrong;
    encoded = out;
  }
  for (int i = 0; i < chain.checksums_inside; ++i)
    if (auto wrong = strip_checksum(encoded); !wrong.empty()) return wrong;
  if (encoded.size() != samples.size())
    return fmt::format("{} bytes, {} expected", encoded.size(), samples.size());
  if (!direct) std::memcpy(samples.data(), encoded.data(), samples.size());
  if (chain.big_endian)
    to_native(samples.data(), samples.size() / form.sample_bytes, form.sample_bytes,
              std::endian::big);
  return {};
}

}  // namespace voxweld
