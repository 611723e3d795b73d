// The deepest valley of a histogram: a threshold where Otsu's fails, when one material is rare.
//
// The counts are laid on at most 256 cells of equal width, smoothed, and taken the root of, so that
// their noise is alike everywhere (M. S. Bartlett, "The Square Root Transformation in Analysis of
// Variance", 1936). The peaks that last are told by their persistence: how far one has to go down
// from a peak to reach a higher one (H. Edelsbrunner, D. Letscher, A. Zomorodian, "Topological
// Persistence and Simplification", 2002).
#pragma once

#include <optional>
#include <span>

#include "stages/ingest/histogram_values.h"
#include "stages/ingest/threshold.h"

namespace voxweld {

// Between the two peaks that last longest; its separability is 1 less the counts in the valley over
// those at the lower peak. None where there is one peak only, but for noise. Same values, same bits.
// Precondition: ascending.
std::optional<Threshold> deepest_valley(std::span<const ValueCount> values);

}  // namespace voxweld
