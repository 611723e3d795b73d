// The one way in: any supported volume file as a SampleSource.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "storage/types/volume_reader.h"

namespace voxweld {

// The one table of volume formats. A further one is a row here; commands, settings and messages
// follow. Of two that know an input equally well the first opens it.
std::span<const VolumeReader> volume_readers();

// "nrrd, metaimage ...": for messages.
std::string reader_names(std::span<const VolumeReader> readers = volume_readers());

// Picks the reader spec.format names or, with "auto", the first that knows the contents, else the
// first that knows the name; opens the input; applies overrides and crop.
// InputError: nothing there, unknown format (the message lists the known ones), bad crop or
// overrides, the reader's module is missing. What the reader throws passes through.
std::unique_ptr<SampleSource> open_volume(const InputSpec& spec,
                                          std::span<const VolumeReader> readers = volume_readers());

// What open_volume looks at for `path`. StorageError when a file is there but cannot be read.
InputProbe probe_input(const std::string& path);

}  // namespace voxweld
