#include "pipeline/ingest/spooled_input.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include "storage/support/error.h"
#include "storage/volumes/filters.h"

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

std::filesystem::path private_name(const std::filesystem::path& folder, std::int64_t layer) {
  std::random_device device;
  return folder / fmt::format("{}{}-{}-{:08x}.raw", prefix, layer, getpid(), device());
}

void remove_spool(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove(path.string() + ".record", ignored);
  std::filesystem::remove(path, ignored);
}

}  // namespace

std::int64_t spool_height(const VolumeInfo& info, std::int64_t shard) {
  if (info.access != Access::chunks) return shard;
  const std::int64_t chunk = std::min(info.chunk.z, info.geometry.size.z);
  return std::max<std::int64_t>(1, (chunk + shard - 1) / shard) * shard;
}

LayerSpools::LayerSpools(std::shared_ptr<SampleSource> input, LayerPlan plan, SpoolOptions options)
    : input_(std::move(input)), plan_(std::move(plan)), options_(std::move(options)) {
  for (const auto& [number, uses] : plan_.uses) layers_[number].uses = uses;
}

LayerSpools::~LayerSpools() {
  for (const auto& [number, layer] : layers_)
    if (layer.samples != nullptr) remove_spool(layer.path);
}

std::shared_ptr<const SampleSource> LayerSpools::acquire(std::int64_t layer) {
  const std::scoped_lock lock(mutex_);
  // Those before it too, so that a stream is read forwards whoever comes first.
  for (auto& [number, entry] : layers_)
    if (number <= layer && !entry.tried && entry.uses > 0) spool(number, entry);
  const Layer& wanted = layers_.at(layer);
  if (wanted.error) std::rethrow_exception(wanted.error);
  return wanted.samples;
}

void LayerSpools::spool(std::int64_t number, Layer& layer) {
  layer.tried = true;
  const VolumeInfo& info = input_->info();
  const Index3 size = info.geometry.size;
  const std::int64_t lo = number * plan_.height, hi = std::min(lo + plan_.height, size.z);
  layer.path = private_name(plan_.folder, number);
  try {
    std::shared_ptr<SampleSource> window = input_;
    if (lo != 0 || hi != size.z) window = crop_source(input_, {{0, 0, lo}, {size.x, size.y, hi}});
    spool_volume(*window, layer.path, plan_.stamp, options_);
    layer.samples = std::make_shared<Slices>(info, open_spool(layer.path, plan_.stamp), lo);
  } catch (const Interrupted&) {
    layer.tried = false;
    remove_spool(layer.path);
    throw;
  } catch (...) {
    layer.error = std::current_exception();
    remove_spool(layer.path);
  }
}

void LayerSpools::release(std::int64_t layer) {
  const std::scoped_lock lock(mutex_);
  Layer& entry = layers_.at(layer);
  if (entry.uses == 0 || --entry.uses > 0) return;
  entry.samples.reset();
  remove_spool(entry.path);
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
