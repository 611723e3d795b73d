// NRRD, attached (.nrrd) and detached (.nhdr): teem.sourceforge.net/nrrd/format.html.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/readers/open_volume.h"
#include "storage/types/volume.h"

namespace voxweld {

Match sniff_nrrd(const InputProbe& probe);

// 3-D scalar volumes, also with further axes of size 1. Encodings raw (Access::box), gzip and text
// (Access::stream). FormatError for others, for vectors and colours, and for damaged files.
std::unique_ptr<SampleSource> open_nrrd(const std::filesystem::path& path);

}  // namespace voxweld
