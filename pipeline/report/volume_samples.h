// What a report shows of a volume: three slices through its middle and a histogram, of as few
// samples as do.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "storage/types/histogram.h"
#include "storage/types/material.h"
#include "storage/types/volume.h"

namespace voxweld {

// Along one side of a slice: samples first, first + step, ... of an axis.
struct SampledSide {
  int axis = 0;
  std::int64_t first = 0, step = 1, count = 0;
  std::int64_t at(std::int64_t i) const { return first + i * step; }
};
// At most `most` samples of `size`, spread evenly, the same distance from both ends or one sample
// more from the upper.
SampledSide sampled_side(int axis, std::int64_t size, int most);

// A slice: of the z axis x runs along columns and y along rows, of the y axis x and z, of the x axis
// y and z.
struct Slice {
  int axis = 2;
  std::int64_t index = 0;  // along the axis
  SampledSide columns, rows;
  std::vector<double> values;    // real ones, a row after the other; or, of labels,
  std::vector<Material> labels;  // as they are stored, exterior where negative

  std::size_t place(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * columns.count + column);
  }
};

struct SampleRequest {
  bool labels = false;            // samples are labels
  int side = 400;                 // of a slice, at most
  std::int64_t most = 1'000'000;  // samples of the histogram, where boxes can be read
  const InterruptFlag* interrupt = nullptr;
};

struct SampleSurvey {
  std::array<Slice, 3> slices;  // of axes z, y, x
  Histogram histogram;
  std::uint64_t counted = 0;  // samples in the histogram
};

// Of a source of boxes only what is needed is read, a band at a time; others are gone through once.
// Throws what source.read throws; Interrupted.
SampleSurvey look_at_samples(const SampleSource& source, const SampleRequest& request);

}  // namespace voxweld
