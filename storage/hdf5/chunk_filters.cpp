#include "storage/hdf5/chunk_filters.h"

#include <fmt/format.h>
#include <lz4.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "storage/hdf5/bit_planes.h"
#include "storage/store/codec.h"
#include "storage/support/byte_order.h"
#include "storage/support/lz4_block.h"

namespace voxweld {
namespace {

// The numbers by which files name filters: those of the library, then registered ones.
enum FilterNumber : int {
  deflate = 1,
  shuffle = 2,
  checksum = 3,
  lzf = 32000,
  blosc = 32001,
  lz4 = 32004,
  bitshuffle = 32008,
  zstd = 32015,
};
constexpr std::size_t checksum_bytes = 4;

bool compresses(const StoredFilter& filter) {
  return filter.number != shuffle && filter.number != checksum;
}

bool known(const StoredFilter& filter) {
  switch (filter.number) {
    case deflate:
    case checksum:
    case lzf:
    case blosc:
    case lz4:
    case zstd:
      return true;
    case shuffle:
      return !filter.values.empty() && filter.values[0] > 0;
    case bitshuffle:  // with lz4, or none: version, version, sample bytes, block, compressor
      return filter.values.size() >= 3 && filter.values[2] > 0 &&
             (filter.values.size() < 5 || filter.values[4] == 0 || filter.values[4] == 2);
    default:
      return false;
  }
}

void unshuffle(std::span<const std::byte> in, std::size_t width, std::span<std::byte> out) {
  const std::size_t count = in.size() / width;
  for (std::size_t byte = 0; byte < width; ++byte) {
    const std::byte* plane = in.data() + byte * count;
    std::byte* to = out.data() + byte;
    for (std::size_t i = 0; i < count; ++i) to[i * width] = plane[i];
  }
  const std::size_t done = count * width;
  std::copy(in.begin() + static_cast<std::ptrdiff_t>(done), in.end(),
            out.begin() + static_cast<std::ptrdiff_t>(done));
}

// The plug-in's form: bytes decoded, bytes a block, then blocks, each with its length before it. A
// block that lz4 does not shorten is stored as it is. Numbers are big-endian.
std::string decode_lz4_blocks(std::span<const std::byte> stored, std::span<std::byte> out) {
  if (stored.size() < 12) return "its lz4 header is cut short";
  const auto total = load_as<std::uint64_t>(stored.data(), 0, std::endian::big);
  const auto block = load_as<std::uint32_t>(stored.data(), 8, std::endian::big);
  if (total != out.size() || block == 0)
    return fmt::format("its lz4 header speaks of {} bytes, {} expected", total, out.size());
  stored = stored.subspan(12);
  while (!out.empty()) {
    const std::size_t bytes = std::min<std::size_t>(block, out.size());
    if (stored.size() < 4) return "its lz4 blocks are cut short";
    const auto length = load_as<std::uint32_t>(stored.data(), 0, std::endian::big);
    stored = stored.subspan(4);
    if (length > stored.size() || bytes > LZ4_MAX_INPUT_SIZE) return "its lz4 blocks are cut short";
    if (length == bytes)
      std::memcpy(out.data(), stored.data(), bytes);
    else if (!lz4_decode_block(stored.first(length), out.first(bytes)))
      return "its lz4 data is damaged";
    stored = stored.subspan(length);
    out = out.subspan(bytes);
  }
  return {};
}

std::string decode_by_codec(CompressorKind kind, std::span<const std::byte> stored,
                            std::span<std::byte> out) {
  CodecChain chain;
  chain.compressor = Compressor{.kind = kind};
  std::vector<std::byte> scratch;
  return decode_chunk(chain, {.bytes = out.size(), .sample_bytes = 1}, stored, out, scratch);
}

std::string decompress_by(const StoredFilter& filter, std::span<const std::byte> stored,
                          std::span<std::byte> out) {
  switch (filter.number) {
    case deflate:
      return decode_by_codec(CompressorKind::gzip, stored, out);
    case blosc:
      return decode_by_codec(CompressorKind::blosc, stored, out);
    case zstd:
      return decode_by_codec(CompressorKind::zstd, stored, out);
    case lz4:
      return decode_lz4_blocks(stored, out);
    case bitshuffle:
      return decode_bit_planes(filter.values, stored, out);
    default:
      return decode_lzf(stored, out);
  }
}

// Bytes of what filter `index` was given, where those before it keep sizes but for checksums.
std::size_t bytes_before(const std::vector<StoredFilter>& filters, std::uint32_t mask,
                         std::size_t index, std::size_t samples) {
  for (std::size_t i = 0; i < index; ++i)
    if (filters[i].number == checksum && (mask >> i & 1) == 0) samples += checksum_bytes;
  return samples;
}

}  // namespace

bool decodes_chunks(const std::vector<StoredFilter>& filters) {
  return filters.size() <= 32 && std::ranges::all_of(filters, known) &&
         std::ranges::count_if(filters, compresses) <= 1;
}

std::string decode_stored_chunk(const std::vector<StoredFilter>& filters, std::uint32_t mask,
                                std::span<const std::byte> stored, std::span<std::byte> samples) {
  std::vector<std::byte> buffer;
  for (std::size_t i = filters.size(); i-- > 0;) {
    if ((mask >> i & 1) != 0) continue;
    const StoredFilter& filter = filters[i];
    if (filter.number == checksum) {
      if (stored.size() < checksum_bytes) return "its checksum is missing";
      const auto data = stored.first(stored.size() - checksum_bytes);
      const auto said = load_as<std::uint32_t>(stored.data(), data.size(), std::endian::little);
      if (const auto found = fletcher32(data); found != said)
        return fmt::format("its checksum is {:08x}, {:08x} expected", found, said);
      stored = data;
      continue;
    }
    const std::size_t bytes =
        filter.number == shuffle ? stored.size() : bytes_before(filters, mask, i, samples.size());
    std::vector<std::byte> next;
    // The last step goes where the samples belong.
    const bool direct = i == 0 && bytes == samples.size();
    if (!direct) next.resize(bytes);
    const std::span<std::byte> out = direct ? samples : std::span(next);
    if (filter.number == shuffle)
      unshuffle(stored, filter.values[0], out);
    else if (auto wrong = decompress_by(filter, stored, out); !wrong.empty())
      return wrong;
    if (!direct) buffer = std::move(next);
    stored = direct ? std::span<const std::byte>(samples) : std::span<const std::byte>(buffer);
  }
  if (stored.size() != samples.size())
    return fmt::format("it has {} bytes, {} expected", stored.size(), samples.size());
  if (stored.data() != samples.data()) std::memcpy(samples.data(), stored.data(), samples.size());
  return {};
}

std::string decode_lzf(std::span<const std::byte> stored, std::span<std::byte> out) {
  std::size_t from = 0, to = 0;
  const auto next = [&] { return std::to_integer<std::size_t>(stored[from++]); };
  while (from < stored.size()) {
    const std::size_t control = next();
    if (control < 32) {  // as many bytes as they are, and one
      const std::size_t count = control + 1;
      if (count > stored.size() - from || count > out.size() - to) return "its lzf data is damaged";
      std::memcpy(out.data() + to, stored.data() + from, count);
      from += count, to += count;
      continue;
    }
    std::size_t count = (control >> 5) + 2;
    if (stored.size() - from < (count == 9 ? 2U : 1U)) return "its lzf data is cut short";
    if (count == 9) count += next();
    const std::size_t back = ((control & 31) << 8) + next() + 1;
    if (back > to || count > out.size() - to) return "its lzf data is damaged";
    // One by one: what is copied may be what was just written.
    for (std::size_t i = 0; i < count; ++i, ++to) out[to] = out[to - back];
  }
  return to == out.size() ? std::string()
                          : fmt::format("its lzf data holds {} bytes, {} expected", to, out.size());
}

std::uint32_t fletcher32(std::span<const std::byte> data) {
  std::uint32_t first = 0, second = 0;
  const auto fold = [](std::uint32_t sum) { return (sum & 0xffffU) + (sum >> 16); };
  const auto value = [&](std::size_t i) { return std::to_integer<std::uint32_t>(data[i]); };
  const std::size_t words = data.size() / 2;
  for (std::size_t word = 0; word < words;) {
    // As many as cannot overflow the second sum.
    for (const std::size_t end = std::min<std::size_t>(words, word + 360); word < end; ++word) {
      first += value(2 * word) << 8 | value(2 * word + 1);
      second += first;
    }
    first = fold(first);
    second = fold(second);
  }
  if (data.size() % 2 == 1) {
    first += value(data.size() - 1) << 8;
    second += first;
    first = fold(first);
    second = fold(second);
  }
  return fold(second) << 16 | fold(first);
}

}  // namespace voxweld
