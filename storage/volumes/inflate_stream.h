// One gzip or zlib stream of a file, decoded piece by piece in a small constant of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/volumes/decoded_stream.h"

namespace voxweld {

// Decoder buffers: input block, zlib's window and tables.
inline constexpr std::uint64_t inflate_memory_bytes = (std::uint64_t{1} << 17) + (64 << 10);

// True for the first bytes of a gzip stream, and of a gzip or zlib stream.
bool looks_gzip(std::span<const std::byte> head);
bool looks_deflated(std::span<const std::byte> head);

// Which of gzip and zlib it is, is told from the first bytes. Concatenated gzip members are one
// stream; bytes after the last member are ignored, as gzip does.
class InflateStream final : public DecodedStream {
 public:
  // The stream starts at byte `offset` of the file. The file must outlive the object.
  InflateStream(const ReadFile& file, std::uint64_t offset);
  ~InflateStream() override;
  InflateStream(const InflateStream&) = delete;
  InflateStream& operator=(const InflateStream&) = delete;

  std::size_t read_some(std::span<std::byte> out) override;
  std::uint64_t decoded() const override { return decoded_; }

 private:
  struct State;

  bool refill();
  bool next_member();

  const ReadFile& file_;
  std::uint64_t offset_;  // of the next byte to read from the file
  std::uint64_t decoded_ = 0;
  bool ended_ = false;
  std::vector<std::byte> input_;
  std::unique_ptr<State> state_;
};

}  // namespace voxweld
