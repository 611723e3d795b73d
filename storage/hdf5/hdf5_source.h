// Boxes of samples out of a dataset.
#pragma once

#include <memory>

#include "storage/hdf5/hdf5_layouts.h"

namespace voxweld {

// Sets access, chunk, largest_decode, files and warnings of what was found. Samples that lie one
// behind the other in the file are read in place; of others whole chunks are decoded, from many
// threads at once where we know their filters, else by libhdf5, one after the other.
// Precondition: found.info.type and geometry are set.
std::unique_ptr<SampleSource> make_hdf5_source(std::shared_ptr<const Hdf5File> file,
                                               FoundVolume found);

}  // namespace voxweld
