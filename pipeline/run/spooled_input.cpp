#include "pipeline/run/spooled_input.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <random>

#include "pipeline/executor/memory_budget.h"
#include "storage/readers/filters.h"

namespace voxweld {
namespace {

constexpr std::string_view prefix = "spool-";

// Slices [lo, ...) of a volume, asked for by the volume's own coordinates.
class Slices final : public SampleSource {
 public:
  Slices(VolumeInfo info, std::unique_ptr<SampleSource> spool, std::int64_t lo)
      : info_(std::move(info)), spool_(std::move(spool)), lo_(lo) {
    info_.access = Access::box;
    info_.largest_decode = spool_->info().largest_decode;
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    const Index3 shift{0, 0, lo_};
    spool_->read({box.lo - shift, box.hi - shift}, out);
  }

 private:
  VolumeInfo info_;
  std::unique_ptr<SampleSource> spool_;
  std::int64_t lo_;
};

std::filesystem::path private_name(const SpoolRequest& request) {
  std::random_device device;
  return request.folder /
         fmt::format("{}{}-{}-{}-{:08x}.raw", prefix, request.lo, request.hi, getpid(), device());
}

void remove_spool(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove(path.string() + ".record", ignored);
  std::filesystem::remove(path, ignored);
}

}  // namespace

SpooledInput spool_slices(const SpoolRequest& request, const SpoolOptions& options) {
  const VolumeInfo& info = request.input->info();
  const Index3 size = info.geometry.size;
  std::shared_ptr<SampleSource> window = request.input;
  if (request.lo != 0 || request.hi != size.z)
    window = crop_source(window, {{0, 0, request.lo}, {size.x, size.y, request.hi}});
  const auto path = private_name(request);
  spdlog::info("the input is read slice by slice: spooling {} once",
               readable_bytes(static_cast<double>(spool_bytes(window->info()))));
  // From here on it goes with the guard, also when spooling fails.
  std::shared_ptr<void> guard(nullptr, [path](void*) { remove_spool(path); });
  spool_volume(*window, path, request.stamp, options);
  return {std::make_shared<Slices>(info, open_spool(path, request.stamp), request.lo),
          std::move(guard)};
}

void remove_spools(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().filename().string().starts_with(prefix)) {
      std::error_code ignored;
      std::filesystem::remove(entry.path(), ignored);
    }
}

}  // namespace voxweld
