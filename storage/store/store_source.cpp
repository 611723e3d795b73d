#include "storage/store/store_source.h"

#include <algorithm>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

// Every size is checked before the reader divides by it; the array on disk must be this one. It may
// say another spacing or unit: those are the config's, and another config may share the samples.
const StoreLayout& checked(const StoreLayout& layout) {
  check_layout(layout);
  StoreLayout there = read_store_layout(layout.array, layout.records);
  const Index3 size = there.geometry.size;
  there.geometry = layout.geometry;
  if (size != layout.geometry.size ||
      render_zarr_array(there.zarr()) != render_zarr_array(layout.zarr()))
    throw DamagedArtifact((layout.array / "zarr.json").string(),
                          "is not the array this run wrote; ingest again");
  return layout;
}

VolumeInfo describe(const StoreLayout& layout, std::uint64_t largest_decode) {
  const ReadFile metadata(layout.array / "zarr.json");
  VolumeInfo info;
  info.format = "zarr";
  info.type = layout.type;
  info.geometry = layout.geometry;
  info.scale = layout.scale;
  info.access = Access::box;
  info.largest_decode = largest_decode;
  info.files.push_back({metadata.path(), metadata.state()});
  return info;
}

std::size_t cached_records(const StoreLayout& layout) {
  const std::int64_t side = layout.chunks();
  const std::uint64_t bytes = static_cast<std::uint64_t>(side * side * side) * sizeof(ValueRange);
  return static_cast<std::size_t>(
      std::clamp<std::uint64_t>((std::uint64_t{16} << 20) / bytes, 1, 64));
}

}  // namespace

std::uint64_t store_decode_bytes(const StoreLayout& layout) {
  return ChunkReader(layout.zarr(), StoreFolder(folder_store(layout.array)), Ownership::ours)
      .largest_decode();
}

StoreSource::StoreSource(const StoreLayout& layout)
    : layout_(checked(layout)),
      reader_(layout_.zarr(), StoreFolder(folder_store(layout_.array)), Ownership::ours),
      records_(cached_records(layout_)) {
  info_ = describe(layout_, reader_.largest_decode());
}

StoreSource::StoreSource(const std::filesystem::path& array, const std::filesystem::path& records)
    : StoreSource(read_store_layout(array, records)) {}

void StoreSource::read(const Box3& box, std::byte* out) const {
  reader_.read(box, out);
}

ValueRange StoreSource::range(const Box3& box) const {
  const Box3 inside = intersect(box, {{}, layout_.geometry.size});
  ValueRange all;
  if (inside.empty()) return all;
  const std::int64_t shard = layout_.parameters.shard, chunk = layout_.parameters.chunk;
  const std::int64_t side = layout_.chunks();
  const Index3 grid = layout_.shard_grid();
  const auto add_shard = [&](Index3 at) {
    const auto key = static_cast<std::uint64_t>((at.z * grid.y + at.y) * grid.x + at.x);
    const auto record = records_.get(key, [&] {
      auto loaded = std::make_shared<ShardRecord>(read_shard_record(layout_, at));
      loaded->histogram.bins = {};  // only the ranges are kept
      return loaded;
    });
    const Box3 part = intersect(inside, layout_.shard_samples(at));
    const Box3 own = {part.lo - at * shard, part.hi - at * shard};
    each_index(pieces_of(own, splat(chunk)), [&](Index3 c) {
      all = merge(all, record->chunks[static_cast<std::size_t>((c.z * side + c.y) * side + c.x)]);
    });
  };
  each_index(pieces_of(inside, splat(shard)), add_shard);
  return all;
}

}  // namespace voxweld
