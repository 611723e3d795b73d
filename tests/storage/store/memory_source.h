// Volumes in memory, and what tests of the store do with them.
#pragma once

#include <cstring>
#include <random>
#include <vector>

#include "stages/ingest/statistics.h"
#include "storage/store/shard_writer.h"
#include "storage/types/volume.h"

namespace voxweld::testing {

class MemorySource final : public SampleSource {
 public:
  MemorySource(SampleType type, Index3 size) {
    info_.format = "memory";
    info_.type = type;
    info_.geometry.size = size;
    samples_.resize(static_cast<std::size_t>(size.x * size.y * size.z) * sample_bytes(type));
  }

  const VolumeInfo& info() const override { return info_; }
  VolumeGeometry& geometry() { return info_.geometry; }
  std::vector<std::byte>& samples() { return samples_; }
  const std::vector<std::byte>& samples() const { return samples_; }
  Box3 all() const { return {{}, info_.geometry.size}; }

  template <class T>
  void set(Index3 at, T value) {
    std::memcpy(samples_.data() + offset(at), &value, sizeof value);
  }

  void read(const Box3& box, std::byte* out) const override {
    const auto row = static_cast<std::size_t>(box.size().x) * sample_bytes(info_.type);
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, out += row)
        std::memcpy(out, samples_.data() + offset({box.lo.x, y, z}), row);
  }

 private:
  std::size_t offset(Index3 at) const {
    const Index3 size = info_.geometry.size;
    return static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x) *
           sample_bytes(info_.type);
  }

  VolumeInfo info_;
  std::vector<std::byte> samples_;
};

inline std::vector<std::byte> read_box(const SampleSource& source, const Box3& box) {
  std::vector<std::byte> out(static_cast<std::size_t>(box.count()) *
                             sample_bytes(source.info().type));
  source.read(box, out.data());
  return out;
}

inline ValueRange value_range(SampleType type, std::span<const std::byte> samples) {
  return HistogramStatistics(type).add(samples);
}

inline Histogram histogram_of(SampleType type, std::span<const std::byte> samples) {
  HistogramStatistics statistics(type);
  statistics.add(samples);
  return statistics.take();
}

// Any bit patterns (NaNs, infinities), with stretches of zero.
inline MemorySource random_source(SampleType type, Index3 size, unsigned seed) {
  MemorySource source(type, size);
  std::mt19937 random(seed);
  const std::size_t stretch = 1 + random() % 4096;
  for (std::size_t i = 0; i < source.samples().size(); ++i)
    source.samples()[i] = static_cast<std::byte>(i / stretch % 3 == 0 ? 0 : random() & 0xff);
  return source;
}

inline StoreLayout layout_for(const SampleSource& source, const std::filesystem::path& array,
                              const StoreParameters& parameters) {
  return {array,
          default_records_directory(array),
          source.info().type,
          source.info().geometry,
          parameters,
          source.info().scale};
}

inline constexpr Hash128 some_key{11, 22};

// Ingests the whole source with one thread.
inline void write_store(const StoreLayout& layout, const SampleSource& source,
                        std::uint64_t band_bytes = 1 << 20) {
  write_store_metadata(layout);
  HistogramStatistics statistics(layout.type);
  ShardScratch scratch;
  scratch.band_bytes = band_bytes;
  const Index3 grid = layout.shard_grid();
  each_index(grid, [&](Index3 shard) {
    write_shard(layout, shard, some_key, source, statistics, scratch);
  });
}

}  // namespace voxweld::testing
