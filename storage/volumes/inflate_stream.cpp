#include "storage/volumes/inflate_stream.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <new>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t input_bytes = std::size_t{1} << 17;
constexpr std::size_t output_step = std::size_t{1} << 30;  // zlib counts in 32 bits
constexpr int any_wrapper = 15 + 32;                       // largest window, gzip or zlib

}  // namespace

struct InflateStream::State {
  z_stream z{};
};

bool looks_gzip(std::span<const std::byte> head) {
  return head.size() >= 3 && head[0] == std::byte{0x1f} && head[1] == std::byte{0x8b} &&
         head[2] == std::byte{8};
}

bool looks_deflated(std::span<const std::byte> head) {
  if (looks_gzip(head)) return true;
  if (head.size() < 2) return false;
  const auto method = std::to_integer<unsigned>(head[0]);
  const auto flags = std::to_integer<unsigned>(head[1]);
  return (method & 15U) == 8 && method >> 4 <= 7 && (method * 256 + flags) % 31 == 0;
}

InflateStream::InflateStream(const ReadFile& file, std::uint64_t offset)
    : file_(file), offset_(offset), state_(std::make_unique<State>()) {
  if (inflateInit2(&state_->z, any_wrapper) != Z_OK) throw std::bad_alloc();
}

InflateStream::~InflateStream() {
  inflateEnd(&state_->z);
}

bool InflateStream::refill() {
  if (offset_ >= file_.size()) return false;
  input_.resize(
      static_cast<std::size_t>(std::min<std::uint64_t>(input_bytes, file_.size() - offset_)));
  file_.read(offset_, input_);
  offset_ += input_.size();
  state_->z.next_in = reinterpret_cast<Bytef*>(input_.data());
  state_->z.avail_in = static_cast<uInt>(input_.size());
  return true;
}

// After the end of a member: true when another gzip member follows, which is then begun.
bool InflateStream::next_member() {
  z_stream& z = state_->z;
  const std::uint64_t at = offset_ - z.avail_in;
  std::byte head[3];
  if (at + sizeof head > file_.size()) return false;
  file_.read(at, head);
  if (!looks_gzip(head)) return false;
  offset_ = at;
  z.avail_in = 0;
  if (inflateReset2(&z, any_wrapper) != Z_OK) throw std::bad_alloc();
  return true;
}

std::size_t InflateStream::read_some(std::span<std::byte> out) {
  z_stream& z = state_->z;
  std::size_t done = 0;
  while (done < out.size() && !ended_) {
    if (z.avail_in == 0 && !refill())
      throw FormatError(
          fmt::format("{}: truncated: the compressed stream breaks off at the file's end, byte {}, "
                      "after {} decoded bytes: get a complete copy of the file",
                      file_.path(), file_.size(), decoded_));
    const std::size_t wanted = std::min(out.size() - done, output_step);
    z.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    z.avail_out = static_cast<uInt>(wanted);
    const int status = inflate(&z, Z_NO_FLUSH);
    const std::size_t got = wanted - z.avail_out;
    done += got;
    decoded_ += got;
    if (status == Z_STREAM_END)
      ended_ = !next_member();
    else if (status == Z_MEM_ERROR)
      throw std::bad_alloc();
    else if (status != Z_OK && status != Z_BUF_ERROR)
      throw FormatError(fmt::format(
          "{}: corrupt compressed data near byte {} of the file, after {} decoded bytes ({}): get "
          "an undamaged copy of the file",
          file_.path(), offset_ - z.avail_in, decoded_,
          z.msg != nullptr ? z.msg : "unexpected stream"));
  }
  return done;
}

}  // namespace voxweld
