// Thresholds from histograms, in the real values that the scale makes of the samples. The same
// histogram gives the same bits, whatever it was merged from.
#pragma once

#include <optional>
#include <string>

#include "storage/types/histogram.h"
#include "storage/types/isovalue.h"
#include "storage/types/value_scale.h"

namespace voxweld {

struct Threshold {
  double value = 0;  // halfway between the two classes' nearest values
  // Between-class over total variance, 0 to 1: how clear the cut is. A single Gaussian reaches
  // 0.64, a uniform distribution 0.75.
  double separability = 0;
};

// Otsu's threshold over the finite samples; none where they are all in one bin.
std::optional<Threshold> otsu_threshold(const Histogram& histogram, const ValueScale& scale = {});

// The smallest value that at least a share q of the finite samples does not exceed, to the width of
// its bin; none where there is no finite sample. Precondition: 0 <= q <= 1.
std::optional<double> quantile(const Histogram& histogram, double q, const ValueScale& scale = {});

struct IsovalueSuggestion {
  Threshold threshold;
  // The value that was taken for padding (what scanners write outside their field of view) and
  // left out.
  std::optional<double> padding;
};

// By that rule, after leaving out padding: an extreme value that at least 1 % of the samples have,
// far from all others, when the others have two clear classes of their own. None where
// otsu_threshold, or deepest_valley (valley.h), has none.
std::optional<IsovalueSuggestion> suggest_isovalue(const Histogram& histogram,
                                                   const ValueScale& scale = {},
                                                   IsovalueRule rule = IsovalueRule::otsu);

// Why there is no suggestion, after "all samples": "have one value, 7", or what the only bin holds.
// Precondition: there is none by Otsu's rule.
std::string no_threshold_text(const Histogram& histogram, const ValueScale& scale = {});

}  // namespace voxweld
