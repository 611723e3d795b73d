#pragma GCC diagnostic ignored "-Wconversion"
#include <fmt/format.h>

#include "pipeline/run/ingest_stage.h"
#include "storage/image/stack_source.h"
#include "storage/spool/box_reader.h"
#include "storage/store/open_zarr.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {
class RawTmp : public SampleSource {
 public:
  RawTmp(const InputConfig& c) : file_(c.path) {
    info_.format = "raw";
    info_.type = *c.type;
    info_.geometry.size = *c.size;
    if (c.spacing) info_.geometry.spacing = *c.spacing;
    info_.files.push_back({c.path.string(), file_.size(), file_.mtime_ns()});
    layout_ = {*c.size, sample_bytes(*c.type), (std::uint64_t)c.header_bytes};
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    read_raw_box(file_, layout_, box, out);
  }
  ReadFile file_;
  VolumeInfo info_;
  RawLayout layout_;
};
}  // namespace
std::shared_ptr<SampleSource> open_input(const InputConfig& c) {
  return std::make_shared<RawTmp>(c);
}
}  // namespace voxweld
