// Boxes out of a raw array in a file, with few system calls.
#pragma once

#include <cstddef>
#include <cstdint>

#include "storage/support/file_io.h"
#include "storage/types/box.h"

namespace voxweld {

// Samples in native byte order, x fastest, tightly packed from `offset` on.
struct RawArray {
  Index3 size;                    // samples a side
  std::uint64_t sample_size = 1;  // bytes
  std::uint64_t offset = 0;       // bytes before sample (0, 0, 0)
};

// Fills `out` with the samples of `box`, x fastest, tightly packed. Rows that lie near each other
// are read together through at most 1 MiB of scratch. Thread-safe.
// Preconditions: box not empty and inside [0, size); the byte size of the array fits 63 bits.
// FormatError when the file ends too early, StorageError when reading fails.
void read_raw_box(const ReadFile& file, const RawArray& layout, const Box3& box, std::byte* out);

}  // namespace voxweld
