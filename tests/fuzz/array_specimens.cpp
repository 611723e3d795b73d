#include <fmt/format.h>
#ifdef VOXWELD_HDF5
#include <hdf5.h>
#endif

#include "tests/fuzz/ball.h"
#include "tests/fuzz/volume_writer.h"
#include "tests/storage/store/array_writers.h"
#include "tests/support/watched_process.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// One with gzip, not sharded.
void write_zarr(const fs::path& folder) {
  fs::create_directories(folder);
  write_bytes(folder / "zarr.json",
              fmt::format(R"({{"zarr_format": 3, "node_type": "array", "shape": [{}, {}, {}],
"data_type": "int16", "chunk_grid": {{"name": "regular", "configuration": {{"chunk_shape": [8, 9, 10]}}}},
"chunk_key_encoding": {{"name": "default", "configuration": {{"separator": "/"}}}}, "fill_value": 0,
"codecs": [{{"name": "bytes", "configuration": {{"endian": "little"}}}},
{{"name": "gzip", "configuration": {{"level": 6}}}}], "attributes": {{}}}}
)",
                          size_z, size_y, size_x));
  for (int z = 0; z < size_z; z += 8)
    for (int y = 0; y < size_y; y += 9)
      for (int x = 0; x < size_x; x += 10) {
        const fs::path chunk =
            folder / "c" / std::to_string(z / 8) / std::to_string(y / 9) / std::to_string(x / 10);
        fs::create_directories(chunk.parent_path());
        write_bytes(chunk, packed(as_string(samples<std::int16_t>(z, z + 8, y, y + 9, x, x + 10))));
      }
}

// A group of OME-Zarr whose one array is of version 2, with zlib, in Fortran order.
void write_ome_zarr(const fs::path& group) {
  const fs::path folder = group / "0";
  fs::create_directories(folder);
  write_bytes(group / ".zgroup", "{\"zarr_format\": 2}\n");
  write_bytes(group / ".zattrs", R"({"multiscales": [{"version": "0.4", "axes": [
{"name": "x", "type": "space", "unit": "millimeter"}, {"name": "y", "type": "space"},
{"name": "z", "type": "space"}], "datasets": [{"path": "0", "coordinateTransformations": [
{"type": "scale", "scale": [1, 1.5, 2]}, {"type": "translation", "translation": [1, 2, 3]}]}]}]}
)");
  write_bytes(
      folder / ".zarray",
      fmt::format(R"({{"zarr_format": 2, "shape": [{0}, {1}, {2}], "chunks": [{0}, {1}, {2}],
"dtype": "<i2", "order": "F", "compressor": {{"id": "zlib", "level": 6}}, "fill_value": 0,
"filters": null, "dimension_separator": "."}}
)",
                  size_x, size_y, size_z));
  // The same samples as one chunk of an array whose axes are x, y, z.
  write_bytes(
      folder / "0.0.0",
      packed(as_string(samples<std::int16_t>(0, size_z, 0, size_y, 0, size_x)), Wrapper::zlib));
}

#ifdef VOXWELD_HDF5
// With chunks, shuffle, deflate and checksums, in a group.
void write_hdf5(const fs::path& path) {
  const hsize_t size[] = {size_z, size_y, size_x}, chunk[] = {8, 9, 10};
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "scan", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(3, size, nullptr), stored = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(stored, 3, chunk);
  H5Pset_shuffle(stored);
  H5Pset_deflate(stored, 6);
  H5Pset_fletcher32(stored);
  const hid_t dataset =
      H5Dcreate2(group, "data", H5T_STD_I16LE, space, H5P_DEFAULT, stored, H5P_DEFAULT);
  const hsize_t three = 3;
  const double spacing[] = {2, 1.5, 1};
  const hid_t row = H5Screate_simple(1, &three, nullptr);
  const hid_t attribute =
      H5Acreate2(dataset, "element_size_um", H5T_NATIVE_DOUBLE, row, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, spacing);
  const std::vector<std::int16_t> all = samples<std::int16_t>();
  const herr_t written =
      H5Dwrite(dataset, H5T_NATIVE_INT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
  H5Aclose(attribute);
  H5Sclose(row);
  H5Dclose(dataset);
  H5Pclose(stored);
  H5Sclose(space);
  H5Gclose(group);
  if (H5Fclose(file) < 0 || written < 0) throw std::runtime_error("cannot write " + path.string());
}
#endif
std::string zarr2_metadata(const std::string& compressor) {
  return fmt::format(R"({{"zarr_format": 2, "shape": [{}, {}, {}], "chunks": [8, 9, 10],
"dtype": "<i2", "order": "C", "compressor": {}, "fill_value": 0, "filters": null}}
)",
                     size_z, size_y, size_x, compressor);
}

// An array of version 2 in a zip file.
std::string zipped_zarr(const ZipForm& form) {
  std::vector<std::pair<std::string, std::string>> members = {{".zarray", zarr2_metadata("null")}};
  for (int z = 0; z < size_z; z += 8)
    for (int y = 0; y < size_y; y += 9)
      for (int x = 0; x < size_x; x += 10)
        members.emplace_back(fmt::format("{}.{}.{}", z / 8, y / 9, x / 10),
                             as_string(samples<std::int16_t>(z, z + 8, y, y + 9, x, x + 10)));
  return zip_of(members, form);
}

// A pyramid of N5 of one level, in blocks of lz4.
void write_n5(const fs::path& group) {
  const fs::path folder = group / "s0";
  fs::create_directories(folder / "0" / "0");
  write_bytes(group / "attributes.json", R"({"n5": "2.0.0", "scales": [[1, 1, 1]],
"pixelResolution": {"unit": "um", "dimensions": [1, 1.5, 2]}}
)");
  write_bytes(folder / "attributes.json",
              fmt::format(R"({{"dimensions": [{0}, {1}, {2}], "blockSize": [{0}, {1}, {3}],
"dataType": "uint8", "compression": {{"type": "lz4"}}}}
)",
                          size_x, size_y, size_z, size_z / 2));
  for (int block = 0; block < 2; ++block)
    write_bytes(folder / "0" / "0" / std::to_string(block),
                n5_header({size_x, size_y, size_z / 2}) +
                    lz4_blocks(as_string(samples<std::uint8_t>(block * size_z / 2,
                                                               (block + 1) * size_z / 2)),
                               1024));
}

// One shard of two, each of two chunks.
void write_nested_shards(const fs::path& folder) {
  fs::create_directories(folder / "c" / "0" / "0");
  const std::string bytes = R"({"name": "bytes", "configuration": {"endian": "little"}})";
  const auto sharding = [&](int z, const std::string& codecs) {
    return fmt::format(
        R"({{"name": "sharding_indexed", "configuration": {{"chunk_shape": [{}, {}, {}],
"codecs": [{}], "index_codecs": [{}, {{"name": "crc32c"}}]}}}})",
        z, size_y, size_x, codecs, bytes);
  };
  write_bytes(
      folder / "zarr.json",
      fmt::format(R"({{"zarr_format": 3, "node_type": "array", "shape": [{0}, {1}, {2}],
"data_type": "int16", "chunk_grid": {{"name": "regular", "configuration": {{"chunk_shape": [{0}, {1}, {2}]}}}},
"chunk_key_encoding": {{"name": "default"}}, "fill_value": 0, "codecs": [{3}], "attributes": {{}}}}
)",
                  size_z, size_y, size_x, sharding(size_z / 2, sharding(size_z / 4, bytes))));
  std::vector<std::string> shards;
  for (int z = 0; z < size_z; z += size_z / 2)
    shards.push_back(shard_of({as_string(samples<std::int16_t>(z, z + size_z / 4)),
                               as_string(samples<std::int16_t>(z + size_z / 4, z + size_z / 2))}));
  write_bytes(folder / "c" / "0" / "0" / "0", shard_of(shards));
}

}  // namespace

void write_arrays(VolumeWriter& to, const std::filesystem::path& program,
                  const std::filesystem::path& scratch) {
  Specimen zarr = to.begin("zarr");
  write_zarr(zarr.folder / "v.zarr");
  to.finish(std::move(zarr), "v.zarr");
  Specimen ome_zarr = to.begin("zarr-ome");
  write_ome_zarr(ome_zarr.folder / "v.zarr");
  to.finish(std::move(ome_zarr), "v.zarr");
  to.add("zarr-zip", {{"v.zarr.zip", zipped_zarr({})}});
  to.add("zarr-zip-deflated", {{"v.zarr.zip", zipped_zarr({.deflate = true, .zip64 = true})}});
  Specimen nested = to.begin("zarr-nested");
  write_nested_shards(nested.folder / "v.zarr");
  to.finish(std::move(nested), "v.zarr");
  Specimen n5 = to.begin("n5");
  write_n5(n5.folder / "v.n5");
  to.finish(std::move(n5), "v.n5");
  if (!program.empty()) {
    Specimen sharded = to.begin("zarr-sharded");
    const ProcessEnd made = run_watched(
        {program.string(), "phantom", "sphere", "--size", "20", "--type", "uint8", "-o", "v.zarr"},
        sharded.folder, scratch / "made");
    if (made.exit_code != 0) throw std::runtime_error(made.err);
    to.finish(std::move(sharded), "v.zarr");
  }
#ifdef VOXWELD_HDF5
  Specimen hdf5 = to.begin("hdf5");
  write_hdf5(hdf5.folder / "v.h5");
  to.finish(std::move(hdf5), "v.h5");
#endif
}

}  // namespace voxweld::testing
