// Spooling what is read in chunks (Access::chunks). Internal to spool.cpp.
#pragma once

#include "storage/spool/spool.h"
#include "storage/support/file_io.h"

namespace voxweld {

// Bytes one thread holds while it reads the least piece: a chunk of samples, and what the source
// holds beside it.
std::uint64_t chunk_spool_memory(const VolumeInfo& info);

// Reads each chunk once and writes its samples to where they belong, x fastest, in as many threads
// as options.threads and options.memory allow. The file is given its size here.
// Throws what the source throws, StorageError, and Interrupted when cancelled.
// Preconditions: Access::chunks; nothing was written to the file; options.memory is at least
// chunk_spool_memory(info).
void write_chunks(const SampleSource& source, AtomicFile& file, const SpoolOptions& options);

}  // namespace voxweld
