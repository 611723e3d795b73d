#include "storage/volumes/decoded_stream.h"

#include <bzlib.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

#include "storage/support/error.h"
#include "storage/volumes/inflate_stream.h"

namespace voxweld {
namespace {

constexpr std::size_t input_block = std::size_t{1} << 17;

// The stored bytes, block by block.
class StoredBytes {
 public:
  StoredBytes(const ReadFile& file, const DataLayout::Part& part)
      : file_(file),
        at_(part.offset),
        end_(std::min(file.size(), part.offset + part.stored_bytes.value_or(file.size()))) {}

  const std::string& path() const { return file_.path(); }
  std::uint64_t at() const { return at_; }  // file offset behind the last block
  // Empty at the end.
  std::span<std::byte> next() {
    block_.resize(
        static_cast<std::size_t>(std::min<std::uint64_t>(input_block, end_ - std::min(at_, end_))));
    if (!block_.empty()) file_.read(at_, block_);
    at_ += block_.size();
    return block_;
  }
  // The byte there, counted from the file's begin, without moving; -1 behind the end.
  int peek(std::uint64_t place) const {
    if (place >= end_) return -1;
    std::byte byte[1];
    file_.read(place, byte);
    return std::to_integer<int>(byte[0]);
  }

 private:
  const ReadFile& file_;
  std::uint64_t at_, end_;
  std::vector<std::byte> block_;
};

[[noreturn]] void fail_cut_off(const StoredBytes& stored, std::uint64_t decoded) {
  throw FormatError(fmt::format(
      "{}: truncated: the compressed stream breaks off at byte {} of the file, after {} "
      "decoded bytes: get a complete copy of the file",
      stored.path(), stored.at(), decoded));
}

// Streams one behind the other are one stream; other bytes behind the last are ignored.
class Bzip2Stream final : public DecodedStream {
 public:
  Bzip2Stream(const ReadFile& file, const DataLayout::Part& part) : stored_(file, part) { begin(); }
  ~Bzip2Stream() override { BZ2_bzDecompressEnd(&z_); }
  Bzip2Stream(const Bzip2Stream&) = delete;
  Bzip2Stream& operator=(const Bzip2Stream&) = delete;

  std::uint64_t decoded() const override { return decoded_; }

  std::size_t read_some(std::span<std::byte> out) override {
    std::size_t done = 0;
    while (done < out.size() && !ended_) {
      if (z_.avail_in == 0 && !refill()) fail_cut_off(stored_, decoded_);
      const std::size_t wanted = std::min(out.size() - done, std::size_t{1} << 30);
      z_.next_out = reinterpret_cast<char*>(out.data() + done);
      z_.avail_out = static_cast<unsigned>(wanted);
      const int status = BZ2_bzDecompress(&z_);
      const std::size_t got = wanted - z_.avail_out;
      done += got;
      decoded_ += got;
      if (status == BZ_STREAM_END)
        next_stream();
      else if (status == BZ_MEM_ERROR)
        throw std::bad_alloc();
      else if (status != BZ_OK)
        throw FormatError(fmt::format(
            "{}: corrupt compressed data near byte {} of the file, after {} decoded bytes (bzip2 "
            "error {}): get an undamaged copy of the file",
            stored_.path(), stored_.at() - z_.avail_in, decoded_, status));
    }
    return done;
  }

 private:
  void begin() {
    if (BZ2_bzDecompressInit(&z_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  bool refill() {
    const auto block = stored_.next();
    z_.next_in = reinterpret_cast<char*>(block.data());
    z_.avail_in = static_cast<unsigned>(block.size());
    return !block.empty();
  }
  void next_stream() {
    const std::uint64_t at = stored_.at() - z_.avail_in;
    ended_ = stored_.peek(at) != 'B' || stored_.peek(at + 1) != 'Z' || stored_.peek(at + 2) != 'h';
    if (ended_) return;
    char* const input = z_.next_in;
    const unsigned left = z_.avail_in;
    BZ2_bzDecompressEnd(&z_);
    z_ = {};
    begin();
    z_.next_in = input;
    z_.avail_in = left;
  }

  StoredBytes stored_;
  bz_stream z_{};
  std::uint64_t decoded_ = 0;
  bool ended_ = false;
};

// Runs of bytes: a count of up to 127 and a byte to repeat, or 128 + a count and as many bytes.
class ByteRleStream final : public DecodedStream {
 public:
  ByteRleStream(const ReadFile& file, const DataLayout::Part& part) : stored_(file, part) {}

  std::uint64_t decoded() const override { return decoded_; }

  std::size_t read_some(std::span<std::byte> out) override {
    std::size_t done = 0;
    while (done < out.size()) {
      if (left_ == 0 && !begin_run()) break;
      const std::size_t count = std::min(left_, out.size() - done);
      if (repeats_)
        std::memset(out.data() + done, value_, count);
      else
        for (std::size_t i = 0; i < count; ++i)
          out[done + i] = static_cast<std::byte>(needed_byte());
      left_ -= count;
      done += count;
      decoded_ += count;
    }
    return done;
  }

 private:
  // Runs of nothing, which no encoder needs, are passed.
  bool begin_run() {
    while (left_ == 0) {
      const int control = next_byte();
      if (control < 0) return false;
      repeats_ = control < 128;
      left_ = static_cast<std::size_t>(control & 127);
      if (repeats_) value_ = needed_byte();
    }
    return true;
  }
  int needed_byte() {
    const int byte = next_byte();
    if (byte < 0) fail_cut_off(stored_, decoded_);
    return byte;
  }
  int next_byte() {  // -1 at the end
    if (used_ == block_.size()) {
      block_ = stored_.next();
      used_ = 0;
      if (block_.empty()) return -1;
    }
    return std::to_integer<int>(block_[used_++]);
  }

  StoredBytes stored_;
  std::span<std::byte> block_;
  std::size_t used_ = 0;
  bool repeats_ = false;
  int value_ = 0;
  std::size_t left_ = 0;  // of the run
  std::uint64_t decoded_ = 0;
};

}  // namespace

bool looks_bzip2(std::span<const std::byte> head) {
  return head.size() >= 4 && std::memcmp(head.data(), "BZh", 3) == 0 && head[3] >= std::byte{'1'} &&
         head[3] <= std::byte{'9'};
}

std::unique_ptr<DecodedStream> open_decoded(DataEncoding encoding, const ReadFile& file,
                                            const DataLayout::Part& part) {
  switch (encoding) {
    case DataEncoding::deflated:
      return std::make_unique<InflateStream>(file, part.offset);
    case DataEncoding::bzip2:
      return std::make_unique<Bzip2Stream>(file, part);
    case DataEncoding::byte_rle:
      return std::make_unique<ByteRleStream>(file, part);
    case DataEncoding::raw:
    case DataEncoding::text:
      break;
  }
  throw std::logic_error("no encoding of a stream of bytes");
}

}  // namespace voxweld
