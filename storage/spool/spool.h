// A spool: a volume that can only be read slice by slice, decoded once into a raw file of which any
// box can be read at once.
//
// <path> holds the samples in native byte order, x fastest, tightly packed; <path>.record says what
// they are and from which key they came. The record is renamed last and removed first, so a record
// never vouches for other data than it was written for.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "storage/support/hash.h"
#include "storage/types/volume.h"

namespace voxweld {

struct SpoolProgress {
  std::uint64_t done = 0, total = 0;  // bytes of decoded samples
};

struct SpoolOptions {
  // Bytes the spooling may hold: one band of rows and what the source holds while decoding.
  std::uint64_t memory = std::uint64_t{256} << 20;
  int threads = 1;  // that may decode at once, where memory allows; of Access::chunks
  std::function<void(const SpoolProgress&)> progress;  // after each band; may be empty
  const std::atomic<bool>* cancel = nullptr;           // set: stop after the current band
};

// Size of the raw file in bytes. InputError when it does not fit 63 bits.
std::uint64_t spool_bytes(const VolumeInfo& info);

// The least SpoolOptions::memory that spool_volume accepts for this source.
std::uint64_t spool_memory_needed(const VolumeInfo& info);

// Decodes each slice of `source` exactly once, in rising order, or each chunk of Access::chunks, in
// any, into the spool `path`; a spool finished before under another key is replaced.
// Throws InputError when `memory` is too small (the message has the figure that would do),
// StorageError when the disk is full or fails, Interrupted when cancelled, and what the source
// throws; nothing is left under `path` then.
void spool_volume(const SampleSource& source, const std::filesystem::path& path, Hash128 key,
                  const SpoolOptions& options);

// The spooled volume: the info of the spooled source, with Access::box. Throws DamagedArtifact when
// it is not a finished spool of this key, StorageError when it cannot be opened.
std::unique_ptr<SampleSource> open_spool(const std::filesystem::path& path, Hash128 key);

// Reads all samples and compares their hash with the record's; DamagedArtifact when they differ.
void verify_spool(const std::filesystem::path& path, Hash128 key);

}  // namespace voxweld
