// Phantoms as files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/phantom/phantom_source.h"

namespace voxweld {

enum class PhantomFormat : std::uint8_t {
  nrrd,           // one file: text header, raw samples
  detached_nrrd,  // .nhdr and .raw beside each other; either name may be given
  zarr,           // a directory
};
// By the file name's extension: .nrrd, .nhdr, .raw, .zarr. InputError for another.
PhantomFormat phantom_format(const std::filesystem::path& path);

// What write_phantom writes there; of a Zarr array its folder alone.
std::vector<std::filesystem::path> phantom_files(const std::filesystem::path& path);

struct PhantomSpec {
  std::filesystem::path path;
  PhantomVolume volume{};
};

struct PhantomHooks {
  // Called from the writing thread with the share of the samples done, 0 to 1.
  std::function<void(double)> progress;
  // Asked now and then; true ends in Interrupted, and no file is left behind.
  std::function<bool()> cancelled;
  // Writes `source` as a Zarr array at `path`; needed for .zarr only.
  std::function<void(const SampleSource& source, const std::filesystem::path& path)> zarr;
};

// Computes the phantom slab by slab, on all threads of the current TBB arena, and writes it:
// samples little-endian, x fastest. Holds two slabs, each of at most 64 slices and 256 MiB (or one
// row), and for each thread PhantomSource's largest_decode; never the volume. The same bytes
// whatever the threads. An existing file is replaced once the new one is complete. InputError for a
// spec that cannot be, StorageError when the disk refuses.
void write_phantom(const PhantomSpec& spec, const PhantomHooks& hooks = {});

// What the header of a phantom's .nrrd or .nhdr says of its true surface.
struct PhantomSurface {
  std::string isovalue, inside;  // as written
};
// Empty where the file is no such header, or the phantom holds labels.
std::optional<PhantomSurface> phantom_surface(const std::filesystem::path& header);

}  // namespace voxweld
