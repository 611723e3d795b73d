#include "storage/dicom/dicom_bytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 13;

// zlib's state, released whatever happens.
struct RawInflate {
  z_stream stream{};
  RawInflate() {
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  }
  ~RawInflate() { inflateEnd(&stream); }
  RawInflate(const RawInflate&) = delete;
  RawInflate& operator=(const RawInflate&) = delete;
};

}  // namespace

void DicomBytes::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (offset > size_ || out.size() > size_ - offset)
    throw FormatError(
        fmt::format("{}: truncated: {} bytes at offset {} are needed, but it ends at {}", path(),
                    out.size(), offset, size_));
  if (inflated_begin_ == 0) return file_.read(offset, out);
  const std::uint64_t before =
      offset < inflated_begin_ ? std::min<std::uint64_t>(inflated_begin_ - offset, out.size()) : 0;
  if (before > 0) file_.read(offset, out.first(before));
  if (before < out.size())
    std::memcpy(out.data() + before, inflated_.data() + (offset + before - inflated_begin_),
                out.size() - before);
}

void DicomBytes::inflate(std::uint64_t begin) {
  RawInflate raw;
  std::vector<std::byte> in(std::size_t{1} << 16), out(std::size_t{1} << 18), all;
  std::uint64_t at = begin;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (raw.stream.avail_in == 0) {
      const std::size_t count =
          static_cast<std::size_t>(std::min<std::uint64_t>(in.size(), file_.size() - at));
      if (count == 0) throw FormatError(path() + ": truncated: its deflated data breaks off");
      file_.read(at, std::span(in).first(count));
      at += count;
      raw.stream.next_in = reinterpret_cast<Bytef*>(in.data());
      raw.stream.avail_in = static_cast<uInt>(count);
    }
    raw.stream.next_out = reinterpret_cast<Bytef*>(out.data());
    raw.stream.avail_out = static_cast<uInt>(out.size());
    status = ::inflate(&raw.stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      throw FormatError(
          fmt::format("{}: its deflated data is damaged before offset {}", path(), at));
    all.insert(all.end(), out.begin(),
               out.end() - static_cast<std::ptrdiff_t>(raw.stream.avail_out));
  }
  all.shrink_to_fit();
  inflated_ = std::move(all);
  inflated_begin_ = begin;
  size_ = begin + inflated_.size();
}

const std::byte* DicomCursor::take(std::size_t length) {
  if (at < block_at_ || at + length > block_at_ + block_.size()) {
    const std::uint64_t left = at < size() ? size() - at : 0;
    const std::size_t wanted = std::max(length, block_size);
    block_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(wanted, left)));
    if (block_.size() < length)
      throw FormatError(
          fmt::format("{}: truncated: {} bytes at offset {} are needed, but it ends at {}",
                      bytes_.path(), length, at, size()));
    bytes_.read(at, block_);
    block_at_ = at;
  }
  const std::byte* found = block_.data() + (at - block_at_);
  at += length;
  return found;
}

template <class T>
T DicomCursor::number() {
  return load_as<T>(take(sizeof(T)), 0, order);
}
template std::uint16_t DicomCursor::number<std::uint16_t>();
template std::uint32_t DicomCursor::number<std::uint32_t>();

std::string DicomCursor::text(std::size_t length) {
  const std::byte* found = take(length);
  return {reinterpret_cast<const char*>(found), length};
}

}  // namespace voxweld
