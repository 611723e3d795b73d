#include "storage/vtk/block_run.h"

#include <fmt/format.h>
#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "storage/support/bounded_cache.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/lz4_block.h"

namespace voxweld {
namespace {

constexpr std::uint64_t largest_block = std::uint64_t{64} << 20;
constexpr std::uint64_t cached_bytes = std::uint64_t{1} << 20;
constexpr std::size_t least_cached = 2;
// What liblzma needs for the largest dictionary its presets have, and a little more.
constexpr std::uint64_t most_lzma_memory = std::uint64_t{80} << 20;
constexpr std::uint64_t usual_decoder_memory = std::uint64_t{64} << 10;

// One byte of a block never stands for more than this.
std::uint64_t best_ratio(BlockCodec codec) {
  return codec == BlockCodec::zlib ? 1032 : codec == BlockCodec::lz4 ? 256 : 10'000;
}

// More than this no encoder makes of a block.
std::uint64_t largest_encoded(std::uint64_t bytes) {
  return bytes + bytes / 4 + 4096;
}

std::vector<std::uint64_t> read_words(const ByteRun& run, std::uint64_t first, std::uint64_t count,
                                      WordForm form) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(count) * form.bytes);
  run.read(first * form.bytes, bytes);
  std::vector<std::uint64_t> words(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = form.bytes == 8 ? load_as<std::uint64_t>(bytes.data(), 8 * i, form.order)
                               : load_as<std::uint32_t>(bytes.data(), 4 * i, form.order);
  return words;
}

std::string inflate_block(std::span<const std::byte> in, std::span<std::byte> out) {
  auto size = static_cast<uLongf>(out.size());
  const int code =
      uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                 reinterpret_cast<const Bytef*>(in.data()), static_cast<uLong>(in.size()));
  if (code != Z_OK) return fmt::format("zlib: {}", zError(code));
  return size == out.size() ? "" : fmt::format("zlib: ends {} bytes short", out.size() - size);
}

// memory: the most it may take; when that is too little, what it would take.
lzma_ret unpack_lzma(std::span<const std::byte> in, std::span<std::byte> out, std::size_t& got,
                     std::uint64_t& memory) {
  std::size_t used = 0;
  return lzma_stream_buffer_decode(
      &memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(in.data()), &used, in.size(),
      reinterpret_cast<std::uint8_t*>(out.data()), &got, out.size());
}

std::string lzma_block(std::span<const std::byte> in, std::span<std::byte> out) {
  std::uint64_t memory = most_lzma_memory;
  std::size_t got = 0;
  const lzma_ret code = unpack_lzma(in, out, got, memory);
  if (code == LZMA_MEMLIMIT_ERROR)
    return fmt::format("lzma: takes {} bytes of memory, at most {} are given", memory,
                       most_lzma_memory);
  if (code != LZMA_OK) return fmt::format("lzma: damaged (error {})", static_cast<int>(code));
  return got == out.size() ? "" : fmt::format("lzma: ends {} bytes short", out.size() - got);
}

std::string decode_block(BlockCodec codec, std::span<const std::byte> in,
                         std::span<std::byte> out) {
  if (codec == BlockCodec::zlib) return inflate_block(in, out);
  if (codec == BlockCodec::lz4) return lz4_decode_block(in, out) ? "" : "lz4: damaged";
  return lzma_block(in, out);
}

class BlockRun final : public ByteRun {
 public:
  BlockRun(std::unique_ptr<ByteRun> compressed, BlockTable table, BlockCodec codec,
           std::string where)
      : compressed_(std::move(compressed)),
        table_(std::move(table)),
        codec_(codec),
        where_(std::move(where)),
        cache_size_(std::max<std::size_t>(
            least_cached, static_cast<std::size_t>(cached_bytes / table_.block_bytes))),
        cache_(cache_size_) {}

  std::uint64_t most_bytes() const override { return table_.total; }

  void read(std::uint64_t at, std::span<std::byte> out) const override {
    while (!out.empty()) {
      const std::uint64_t block = at / table_.block_bytes;
      const std::uint64_t within = at - block * table_.block_bytes;
      const std::size_t size = block_size(block);
      const std::size_t count = std::min(out.size(), size - static_cast<std::size_t>(within));
      if (count == size) {
        load(block, out.first(size));
      } else {
        const auto held = cache_.get(block, [&] {
          auto bytes = std::make_shared<std::vector<std::byte>>(size);
          load(block, *bytes);
          return bytes;
        });
        std::memcpy(out.data(), held->data() + within, count);
      }
      out = out.subspan(count);
      at += count;
    }
  }

  // Beyond the caller's buffer.
  std::uint64_t memory() const {
    std::uint64_t largest = 0;
    for (std::size_t i = 0; i + 1 < table_.starts.size(); ++i)
      largest = std::max(largest, table_.starts[i + 1] - table_.starts[i]);
    return (cache_size_ + 1) * table_.block_bytes + largest + decoder_memory() +
           table_.starts.size() * sizeof(std::uint64_t);
  }

 private:
  std::size_t block_size(std::uint64_t block) const {
    return static_cast<std::size_t>(
        std::min(table_.block_bytes, table_.total - block * table_.block_bytes));
  }

  std::vector<std::byte> compressed_block(std::uint64_t block) const {
    const auto i = static_cast<std::size_t>(block);
    std::vector<std::byte> bytes(static_cast<std::size_t>(table_.starts[i + 1] - table_.starts[i]));
    compressed_->read(table_.starts[i], bytes);
    return bytes;
  }

  void load(std::uint64_t block, std::span<std::byte> out) const {
    const std::string wrong = decode_block(codec_, compressed_block(block), out);
    if (!wrong.empty())
      throw FormatError(fmt::format("{}: block {} of {}: {}: get an undamaged copy of the file",
                                    where_, block, table_.starts.size() - 1, wrong));
  }

  // Of lzma the first block tells: one writer has made them all.
  std::uint64_t decoder_memory() const {
    if (codec_ != BlockCodec::lzma) return usual_decoder_memory;
    std::uint64_t memory = 1;
    std::size_t got = 0;
    std::byte nothing[1];
    if (unpack_lzma(compressed_block(0), nothing, got, memory) != LZMA_MEMLIMIT_ERROR)
      return usual_decoder_memory;
    return std::min(memory, most_lzma_memory);
  }

  std::unique_ptr<ByteRun> compressed_;
  BlockTable table_;
  BlockCodec codec_;
  std::string where_;
  std::size_t cache_size_;
  mutable BoundedCache<std::vector<std::byte>> cache_;
};

void check_blocks(const BlockTable& table, std::uint64_t count, std::uint64_t last,
                  std::uint64_t needed, const std::string& where) {
  const auto fail = [&](const std::string& what) {
    throw FormatError(fmt::format(
        "{}: {} (the header in front of the compressed data says {} blocks of {} bytes, the last "
        "of {}): damaged, or another byte_order or header_type than the file says",
        where, what, count, table.block_bytes, last));
  };
  if (count == 0 || table.block_bytes == 0) fail("no blocks");
  if (last > table.block_bytes) fail("the last block is larger than the others");
  // In double: only that the two are the same matters, which is looked at in integers then.
  const double total = static_cast<double>(count) * static_cast<double>(table.block_bytes);
  if (total > 0x1p62) fail("more bytes than any file holds");
  if (table.total != needed) fail(fmt::format("{} bytes of samples were announced", needed));
  if (std::min(table.block_bytes, needed) > largest_block)
    fail(fmt::format("blocks larger than {} bytes are not supported: write smaller ones",
                     largest_block));
}

}  // namespace

BlockTable read_block_table(const ByteRun& run, WordForm form, std::uint64_t needed,
                            BlockCodec codec, const std::string& where) {
  const std::vector<std::uint64_t> head = read_words(run, 0, 3, form);
  const std::uint64_t count = head[0], last = head[2];
  BlockTable table;
  table.block_bytes = head[1];
  table.total = count * head[1] - (last == 0 ? 0 : head[1] - last);
  check_blocks(table, count, last, needed, where);
  const std::uint64_t stored = run.most_bytes();
  if (count > stored / form.bytes)
    throw FormatError(
        fmt::format("{}: truncated: {} blocks are announced, the file has {} bytes "
                    "for them: get a complete copy",
                    where, count, stored));
  table.block_bytes = std::min(table.block_bytes, needed);
  const std::vector<std::uint64_t> sizes = read_words(run, 3, count, form);
  table.starts.reserve(sizes.size() + 1);
  table.starts.push_back(0);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::uint64_t begin = i * table.block_bytes;
    const std::uint64_t decoded = std::min(table.block_bytes, needed - begin);
    if (sizes[i] > largest_encoded(decoded) || sizes[i] < decoded / best_ratio(codec))
      throw FormatError(fmt::format(
          "{}: block {} of {}: {} bytes do not decode to {}: damaged, or another byte_order or "
          "header_type than the file says",
          where, i, sizes.size(), sizes[i], decoded));
    table.starts.push_back(table.starts.back() + sizes[i]);
  }
  if (table.starts.back() > stored)
    throw FormatError(
        fmt::format("{}: truncated: {} compressed bytes are announced, the file has "
                    "{}: get a complete copy",
                    where, table.starts.back(), stored));
  return table;
}

OpenedBlocks open_blocks(std::unique_ptr<ByteRun> compressed, BlockTable table, BlockCodec codec,
                         const std::string& where) {
  auto run = std::make_unique<BlockRun>(std::move(compressed), std::move(table), codec, where);
  const std::uint64_t memory = run->memory();
  return {std::move(run), memory};
}

}  // namespace voxweld
