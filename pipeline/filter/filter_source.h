// A volume as a filter of the config leaves it: a source around a source.
#pragma once

#include <memory>

#include "pipeline/filter/filter_request.h"
#include "storage/types/volume.h"

namespace voxweld {

// Access::box, from any thread; boxes of any size take at most info().largest_decode for each
// thread beside the caller's buffer. Files, choices and warnings are the source's. The place in the
// world is the same: what is turned or made coarser has other directions, origin and spacing, and
// its coordinates count from 0.
// Precondition: `source` is of Access::box. InputError, naming the filter, for what does not fit
// it.
std::shared_ptr<SampleSource> filter_source(std::shared_ptr<SampleSource> source,
                                            const FilterRequest& request);

// Whether reading through the filter costs no more than reading: then no store is made for it.
bool reads_through(const FilterConfig& filter);
// Whether samples change their places.
bool moves_samples(const FilterConfig& filter);

}  // namespace voxweld
