// The sidecar of a spool: what its raw file holds. A container (storage/artifact) of kind "spol"
// with three sections:
//   1  facts, one SpoolFacts
//   2  texts: for each of format, unit, space, the file paths and the warnings a u64 length and
//      the characters
//   3  files: one (size u64, mtime_ns i64, ctime_ns i64) each, in the order of their paths in section 2
#pragma once

#include <filesystem>

#include "storage/support/hash.h"
#include "storage/types/volume.h"

namespace voxweld {

struct SpoolRecord {
  Hash128 key;        // of what was spooled
  Hash128 data_hash;  // XXH3-128 of the raw file
  VolumeInfo info;    // of what was spooled
};

// <path>.record
std::filesystem::path spool_record_path(const std::filesystem::path& path);
void write_spool_record(const std::filesystem::path& path, const SpoolRecord& record);
// DamagedArtifact when the record fails its checks, StorageError when it cannot be read.
SpoolRecord read_spool_record(const std::filesystem::path& path);

}  // namespace voxweld
