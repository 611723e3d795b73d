#include <fmt/format.h>

#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/readers.h"

namespace voxweld {

namespace {

Match test_raw(const InputProbe& probe) {
  const bool named = probe.extension == ".raw" || probe.extension == ".bin";
  return probe.is_file && named ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_raw(const InputSpec& spec) {
  const RawPieces& raw = spec.raw;
  if (!raw.size || !raw.type)
    throw InputError(fmt::format("{}: headerless samples say nothing about themselves: give {}",
                                 spec.path,
                                 !raw.size && !raw.type ? "size and type"
                                 : !raw.size            ? "the size"
                                                        : "the type"));
  if (raw.header_bytes < -1)
    throw InputError(
        fmt::format("{}: header bytes: expected 0 or more, or -1 for samples at the "
                    "file's end, found {}",
                    spec.path, raw.header_bytes));
  const Index3 size = *raw.size;
  if (size.x <= 0 || size.y <= 0 || size.z <= 0)
    throw InputError(fmt::format("{}: size: expected three positive numbers, found {} {} {}",
                                 spec.path, size.x, size.y, size.z));
  require_input_file(spec.path);
  VolumeInfo info;
  info.format = "raw";
  info.type = *raw.type;
  info.geometry.size = size;
  DataLayout data;
  data.parts = {{spec.path, 0, 0}};
  data.byte_order = raw.byte_order;
  data.samples_at_end = raw.header_bytes == -1;
  data.skip_bytes = data.samples_at_end ? 0 : raw.header_bytes;
  data.named_by = spec.path;
  return open_layout(std::move(info), std::move(data));
}

}  // namespace

VolumeReader raw_reader() {
  return {"raw", "headerless samples, .raw", test_raw, open_raw};
}

}  // namespace voxweld
