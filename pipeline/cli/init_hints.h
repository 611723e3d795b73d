// What `init` says of an input beside the config it writes: what the user may know better.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/histogram.h"
#include "storage/types/volume.h"

namespace voxweld {

// Whether samples look like labels: integers whose values change in steps. Two samples that differ
// have a second one of the same value behind them, as in objects that are a few samples thick. Scans
// and distance fields rise over several samples, and noise changes all the time.
class LabelLook {
 public:
  explicit LabelLook(SampleType type) : type_(type) {}

  // Of whole rows.
  void add(const Box3& band, std::span<const std::byte> samples);
  bool like_labels() const;

 private:
  SampleType type_;
  bool negative_ = false;
  std::uint64_t changes_ = 0, steps_ = 0;
};

// Whether the user said these on the command line.
struct GivenOptions {
  bool spacing = false, unit = false, labels = false;
};

struct SeenVolume {
  const VolumeInfo& info;
  const LabelLook& look;
  const Histogram& histogram;
};

// One line each.
std::vector<std::string> volume_hints(const std::string& path, const SeenVolume& seen,
                                      GivenOptions given);
std::vector<std::string> mesh_hints(const std::string& path, GivenOptions given);

}  // namespace voxweld
