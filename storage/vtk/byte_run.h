// Bytes of a file behind an encoding that lets any of them be read by itself.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "storage/support/file_io.h"
#include "storage/types/volume.h"

namespace voxweld {

class ByteRun {
 public:
  virtual ~ByteRun() = default;
  // Fills `out` from byte `at` of the decoded bytes on; from any thread. FormatError where they end
  // before, or are damaged.
  virtual void read(std::uint64_t at, std::span<std::byte> out) const = 0;
  // No more bytes than this can be there.
  virtual std::uint64_t most_bytes() const = 0;
};

// Where stored bytes lie in a file: from begin to before end.
struct FileSpan {
  std::shared_ptr<const ReadFile> file;
  std::uint64_t begin = 0, end = 0;
};

// As they are.
std::unique_ptr<ByteRun> plain_run(FileSpan span);
// Base64 without line breaks.
std::unique_ptr<ByteRun> base64_run(FileSpan span);

// Samples, x fastest, that begin `skip` bytes into the run.
struct SampleRun {
  std::unique_ptr<ByteRun> bytes;
  std::uint64_t skip = 0;
  std::endian byte_order = std::endian::little;
};
// info as the reader has settled it, with access, chunk and largest_decode: of a run of blocks they
// are more than the bytes asked for. Any box, from any thread.
std::unique_ptr<SampleSource> run_source(VolumeInfo info, SampleRun run);

}  // namespace voxweld
