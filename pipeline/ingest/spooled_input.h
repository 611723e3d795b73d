// An input that is not read by boxes, layer by layer of a brick store's shards: the slices of a
// layer are decoded once into a raw file of which any box can be read, and that goes when its
// shards are done. Every process has its own files, so that two copies of a task do not meet.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "storage/spool/spool.h"
#include "storage/types/volume.h"

namespace voxweld {

// Slices of a layer, a multiple of the shards' side: one layer of shards, or, where chunks are
// taller, as much as holds one, so that no chunk is decoded more than twice. Samples.
std::int64_t spool_height(const VolumeInfo& info, std::int64_t shard);

struct LayerPlan {
  std::filesystem::path folder;  // where spools go
  Hash128 stamp;                 // of the input
  std::int64_t height = 256;     // slices of a layer; layer k is [k * height, (k + 1) * height)
  std::map<std::int64_t, std::size_t> uses;  // of each layer that is wanted: how often
};

// Thread-safe; the input is read by one thread at a time, in rising order of slices.
class LayerSpools {
 public:
  LayerSpools(std::shared_ptr<SampleSource> input, LayerPlan plan, SpoolOptions options);
  ~LayerSpools();

  // The samples in the input's own coordinates, those of the layer only. Throws what spool_volume
  // throws, to each who asks for that layer. Precondition: the plan has it.
  std::shared_ptr<const SampleSource> acquire(std::int64_t layer);
  // One use less, whether it was acquired or not.
  void release(std::int64_t layer);

 private:
  struct Layer {
    std::size_t uses = 0;
    bool tried = false;
    std::shared_ptr<const SampleSource> samples;
    std::filesystem::path path;
    std::exception_ptr error;
  };
  void spool(std::int64_t number, Layer& layer);

  const std::shared_ptr<SampleSource> input_;
  const LayerPlan plan_;
  const SpoolOptions options_;
  std::mutex mutex_;
  std::map<std::int64_t, Layer> layers_;
};

// Those that processes left behind when they were killed. Precondition: nobody spools there.
void remove_spools(const std::filesystem::path& folder);

}  // namespace voxweld
