#include "storage/volumes/raw_reader.h"

#include <fmt/format.h>

#include <cmath>

#include "storage/support/error.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

std::unique_ptr<SampleSource> open_raw(const RawLayout& layout) {
  const std::string where = layout.path.string();
  if (layout.header_bytes < -1)
    throw InputError(
        fmt::format("{}: header bytes: expected 0 or more, or -1 for samples at the "
                    "file's end, found {}",
                    where, layout.header_bytes));
  for (int axis = 0; axis < 3; ++axis) {
    if (layout.size[axis] <= 0)
      throw InputError(fmt::format("{}: size: expected three positive numbers, found {} {} {}",
                                   where, layout.size.x, layout.size.y, layout.size.z));
    if (!std::isfinite(layout.spacing[axis]) || layout.spacing[axis] <= 0)
      throw InputError(fmt::format("{}: spacing: expected three positive numbers, found {} {} {}",
                                   where, layout.spacing.x, layout.spacing.y, layout.spacing.z));
  }
  require_input_file(layout.path);
  VolumeInfo info;
  info.format = "raw";
  info.type = layout.type;
  info.geometry.size = layout.size;
  info.geometry.spacing = layout.spacing;
  info.geometry.unit = canonical_unit(layout.unit);
  DataLayout data;
  data.parts = {{layout.path, 0, 0}};
  data.byte_order = layout.byte_order;
  data.samples_at_end = layout.header_bytes == -1;
  data.skip_bytes = data.samples_at_end ? 0 : layout.header_bytes;
  data.named_by = where;
  return open_layout(std::move(info), std::move(data));
}

namespace {

Match test_raw(const InputProbe& probe) {
  const bool named = probe.extension == ".raw" || probe.extension == ".bin";
  return probe.is_file && named ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_raw_spec(const InputSpec& spec) {
  if (!spec.raw.size || !spec.raw.type)
    throw InputError(fmt::format("{}: headerless samples say nothing about themselves: give {}",
                                 spec.path,
                                 !spec.raw.size && !spec.raw.type ? "size and type"
                                 : !spec.raw.size                 ? "the size"
                                                                  : "the type"));
  RawLayout layout;
  layout.path = spec.path;
  layout.size = *spec.raw.size;
  layout.type = *spec.raw.type;
  layout.byte_order = spec.raw.byte_order;
  layout.header_bytes = spec.raw.header_bytes;
  return open_raw(layout);
}

}  // namespace

VolumeReader raw_reader() {
  return {"raw", "headerless samples, .raw", test_raw, open_raw_spec};
}

}  // namespace voxweld
