// Which dimension of a dataset is which axis of the volume, and the place in the others.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "storage/hdf5/hdf5_dataset.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

struct VolumePlace {
  std::array<int, 3> dimension{-1, -1, -1};  // of the dataset, of x, y, z; -1: of one sample
  std::vector<std::int64_t> at;              // index in each of the other dimensions
};

// Lower-case names of the dimensions, one a dimension: "x", "y", "z", "c", "t" or others. From the
// attributes axistags (vigra, ilastik) or DIMENSION_LABELS. Empty where there are none.
std::vector<std::string> dimension_names(hid_t dataset, std::size_t rank);

// By the names where they name x, y and z, else the last three dimensions that have several samples
// as z, y, x. names: as dimension_names, or of another source. Adds to info.choices.
// InputError where channel or time is left open, or is set where there is none; FormatError where
// further dimensions have several samples.
VolumePlace place_volume(const DatasetFacts& facts, const std::vector<std::string>& names,
                         const InputSpec& spec, const std::string& where, VolumeInfo& info);

// The index among `count` things that the spec's channel, time or level says. What is not said is 0
// where there is one only; else an InputError that lists what there is, or of a survey a warning.
// texts: of each, may be empty. Adds to info.choices where there are several.
struct IndexChoice {
  Selector selector = Selector::channel;
  std::optional<std::int64_t> wanted{};
  std::int64_t count = 1;
  std::vector<std::string> texts{};
  bool first_is_fine = false;  // what is left open is 0 without a word: of levels
};
std::int64_t choose_index(const IndexChoice& choice, bool survey, const std::string& where,
                          VolumeInfo& info);

Index3 size_of(const DatasetFacts& facts, const VolumePlace& place);

}  // namespace voxweld
