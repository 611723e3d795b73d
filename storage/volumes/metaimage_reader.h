// MetaImage, .mha (header and samples) and .mhd (header beside the samples), as ITK reads them.
#pragma once

#include <filesystem>
#include <memory>

#include "storage/readers/open_volume.h"
#include "storage/types/volume.h"

namespace voxweld {

Match sniff_metaimage(const InputProbe& probe);

// 3-D scalar volumes, also with further axes of size 1. Raw samples are Access::box, compressed and
// text ones Access::stream. FormatError for several channels and for damaged files.
std::unique_ptr<SampleSource> open_metaimage(const std::filesystem::path& path);

}  // namespace voxweld
