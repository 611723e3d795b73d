#include "storage/volumes/dense_source.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

DenseSource::DenseSource(SampleType type, const VolumeGeometry& geometry,
                         std::vector<std::byte> samples)
    : samples_(std::move(samples)) {
  info_.format = "dense";
  info_.type = type;
  info_.geometry = geometry;
  info_.access = Access::box;
  const std::uint64_t bytes = checked_volume_bytes(geometry.size, type, "volume in memory");
  if (samples_.size() != bytes)
    throw InputError(
        fmt::format("volume in memory: {} x {} x {} samples of {} take {} bytes, {} "
                    "were given",
                    geometry.size.x, geometry.size.y, geometry.size.z, sample_type_name(type),
                    bytes, samples_.size()));
}

void DenseSource::read(const Box3& box, std::byte* out) const {
  require_inside(box, info_);
  const Index3 size = info_.geometry.size;
  const auto width = static_cast<std::int64_t>(sample_bytes(info_.type));
  const auto row = static_cast<std::size_t>(box.size().x * width);
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, out += row)
      std::memcpy(out, samples_.data() + ((z * size.y + y) * size.x + box.lo.x) * width, row);
}

}  // namespace voxweld
