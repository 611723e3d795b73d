#include "storage/store/layout.h"

#include <fmt/format.h>

#include <cmath>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/types/counted_from_zero.h"

namespace voxweld {
namespace {

constexpr std::int64_t largest_chunk = 512;         // 2^30 bytes of 8-byte samples: blosc's limit
constexpr std::int64_t largest_chunks_a_side = 64;  // the index of a shard stays under 4 MiB

std::int64_t divide_up(std::int64_t a, std::int64_t b) {
  return (a + b - 1) / b;
}

CodecChain store_codecs(const StoreParameters& parameters, SampleType type) {
  CodecChain chain;
  chain.checksums_outside = parameters.compression == StoreCompression::none ? 0 : 1;
  chain.checksums_inside = 1 - chain.checksums_outside;
  if (parameters.compression == StoreCompression::none) return chain;
  Compressor compressor;
  compressor.cname = parameters.compression == StoreCompression::lz4 ? "lz4" : "zstd";
  compressor.level = parameters.level;
  compressor.shuffle = sample_bytes(type) > 1 ? Shuffle::byte : Shuffle::none;
  chain.compressor = compressor;
  return chain;
}

void check_geometry(const VolumeGeometry& geometry, SampleType type) {
  std::int64_t bytes = static_cast<std::int64_t>(sample_bytes(type));
  bool finite = true;
  for (int axis = 0; axis < 3; ++axis) {
    if (geometry.size[axis] < 1)
      throw InputError(
          fmt::format("a brick store needs at least one sample on each axis, {} x {} x {} given",
                      geometry.size.x, geometry.size.y, geometry.size.z));
    if (__builtin_mul_overflow(bytes, geometry.size[axis], &bytes))
      throw InputError(fmt::format("a volume of {} x {} x {} samples is more than 2^63 bytes",
                                   geometry.size.x, geometry.size.y, geometry.size.z));
    if (!(geometry.spacing[axis] > 0) || !std::isfinite(geometry.spacing[axis]))
      throw InputError(fmt::format("spacing must be positive on each axis, {} given for {}",
                                   geometry.spacing[axis], "xyz"[axis]));
    finite = finite && std::isfinite(geometry.origin[axis]);
    for (const Vec3& direction : geometry.direction)
      finite = finite && std::isfinite(direction[axis]);
  }
  if (!finite) throw InputError("the volume's origin and direction must be finite numbers");
}

}  // namespace

Index3 StoreLayout::shard_grid() const {
  const std::int64_t side = parameters.shard;
  return {divide_up(geometry.size.x, side), divide_up(geometry.size.y, side),
          divide_up(geometry.size.z, side)};
}

std::int64_t StoreLayout::chunks() const {
  return parameters.shard / parameters.chunk;
}

Box3 StoreLayout::shard_samples(Index3 shard) const {
  const Index3 lo = shard * parameters.shard;
  return intersect({lo, lo + splat(parameters.shard)}, {{}, geometry.size});
}

std::filesystem::path StoreLayout::shard_path(Index3 shard) const {
  return zarr().file_path(shard);
}

std::filesystem::path StoreLayout::record_path(Index3 shard) const {
  return records / std::to_string(shard.z) / std::to_string(shard.y) /
         (std::to_string(shard.x) + ".shard");
}

ZarrArray StoreLayout::zarr() const {
  ZarrArray zarr;
  zarr.path = array;
  zarr.type = type;
  zarr.size = geometry.size;
  zarr.file.assign(3, parameters.shard);
  zarr.chunk.assign(3, parameters.chunk);
  zarr.shards = {{zarr.chunk, {0, 1, 2}, {}}};
  zarr.codecs = store_codecs(parameters, type);
  zarr.geometry = counted_from_zero(geometry);  // other programs know no `first`
  zarr.scale = scale;
  return zarr;
}

std::filesystem::path default_records_directory(const std::filesystem::path& array) {
  return array / ".voxweld";
}

void check_layout(const StoreLayout& layout) {
  const auto& [chunk, shard, compression, level] = layout.parameters;
  if (chunk < 1 || chunk > largest_chunk)
    throw InputError(
        fmt::format("the chunk of a brick store must be 1 to {} samples a side, {} given",
                    largest_chunk, chunk));
  if (shard < chunk || shard % chunk != 0 || shard / chunk > largest_chunks_a_side)
    throw InputError(fmt::format(
        "the shard of a brick store must be 1 to {} chunks of {} samples a side, {} samples given",
        largest_chunks_a_side, chunk, shard));
  if (level < 0 || level > 9)
    throw InputError(fmt::format("the compression level must be 0 to 9, {} given", level));
  check_geometry(layout.geometry, layout.type);
}

void write_store_metadata(const StoreLayout& layout) {
  check_layout(layout);
  const std::string text = render_zarr_array(layout.zarr());
  write_whole_file(layout.array / "zarr.json", as_bytes(text), Durability::rename_only);
}

bool store_metadata_is_current(const StoreLayout& layout) {
  const std::filesystem::path path = layout.array / "zarr.json";
  return std::filesystem::exists(path) && read_text_file(path) == render_zarr_array(layout.zarr());
}

StoreLayout read_store_layout(const std::filesystem::path& array,
                              const std::filesystem::path& records) {
  const std::string file = (array / "zarr.json").string();
  const ZarrArray zarr = read_zarr_array(array);
  if (!zarr.geometry)
    throw FormatError(file + ": not a brick store (no \"voxweld\" in its attributes)");
  StoreLayout layout{array, records, zarr.type, *zarr.geometry, {}, zarr.scale};
  layout.parameters.chunk = zarr.chunk.back();
  layout.parameters.shard = zarr.file.back();
  const auto& compressor = zarr.codecs.compressor;
  layout.parameters.compression = !compressor                  ? StoreCompression::none
                                  : compressor->cname == "lz4" ? StoreCompression::lz4
                                                               : StoreCompression::zstd;
  if (compressor) layout.parameters.level = compressor->level;
  // Whatever was changed in the file, its text is then not the one this layout is written as.
  if (render_zarr_array(layout.zarr()) != read_text_file(array / "zarr.json"))
    throw DamagedArtifact(file, "changed since it was written; ingest again");
  return layout;
}

}  // namespace voxweld
