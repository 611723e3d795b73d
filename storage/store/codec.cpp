#include "storage/store/codec.h"

#include <blosc.h>
#include <fmt/format.h>
#include <zstd.h>

#include <cstring>

#include "storage/store/crc32c.h"
#include "storage/store/decompress.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t checksum_bytes = 4;

// How many bytes the compressor was given.
std::size_t inner_bytes(const CodecChain& chain, ChunkForm form) {
  return form.bytes + checksum_bytes * static_cast<std::size_t>(chain.checksums_inside);
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

const char* compressor_name(CompressorKind kind) {
  static constexpr const char* names[] = {"blosc", "zstd", "gzip", "bz2", "lz4", "lz4", "xz"};
  return names[static_cast<std::size_t>(kind)];
}

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
