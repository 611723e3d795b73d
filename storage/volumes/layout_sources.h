// The two kinds of source behind open_layout, which has settled and checked the layout before.
#pragma once

#include <memory>

#include "storage/volumes/data_layout.h"

namespace voxweld {

// Raw samples: any box, from any thread (Access::box).
std::unique_ptr<SampleSource> make_raw_source(VolumeInfo info, const DataLayout& layout);

// Deflated or text samples: whole slices with z rising; a lower z starts again at the first sample
// (Access::stream).
std::unique_ptr<SampleSource> make_stream_source(VolumeInfo info, const DataLayout& layout);

}  // namespace voxweld
