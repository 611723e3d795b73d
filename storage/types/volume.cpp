#include "storage/types/volume.h"

#include <fmt/format.h>

namespace voxweld {

std::string no_labels_text(const VolumeInfo& info) {
  if (info.type == SampleType::f32 || info.type == SampleType::f64)
    return fmt::format("has samples of {}", sample_type_name(info.type));
  if (!info.scale.identity())
    return fmt::format(
        "says that real values are {} * stored + {} (to keep labels in it, store "
        "them with slope 1 and intercept 0)",
        info.scale.slope, info.scale.intercept);
  return {};
}

}  // namespace voxweld
