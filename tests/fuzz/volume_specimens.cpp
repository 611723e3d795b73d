// Volumes in every format that is read.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>

#ifdef VOXWELD_HDF5
#include <hdf5.h>
#endif

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/specimens.h"
#include "tests/fuzz/vtk_specimens.h"
#include "tests/storage/dicom/dicom_writer.h"
#include "tests/storage/image/tiff_writer.h"
#include "tests/storage/store/array_writers.h"
#include "tests/support/deflated.h"
#include "tests/support/watched_process.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr int size_x = 20, size_y = 18, size_z = 16;

std::int16_t value_at(int x, int y, int z) {
  const int square = (x - 9) * (x - 9) + (y - 9) * (y - 9) + (z - 8) * (z - 8);
  return static_cast<std::int16_t>(std::max(10, 230 - 4 * square));
}

// The samples of a box, x fastest, as T.
template <class T>
std::vector<T> samples(int z_begin = 0, int z_end = size_z, int y_begin = 0, int y_end = size_y,
                       int x_begin = 0, int x_end = size_x) {
  std::vector<T> all;
  for (int z = z_begin; z < z_end; ++z)
    for (int y = y_begin; y < y_end; ++y)
      for (int x = x_begin; x < x_end; ++x) all.push_back(static_cast<T>(value_at(x, y, z)));
  return all;
}

template <class T>
std::string as_string(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string packed(const std::string& bytes, Wrapper wrapper = Wrapper::gzip) {
  const auto out = deflated(std::as_bytes(std::span(bytes)), wrapper);
  return {reinterpret_cast<const char*>(out.data()), out.size()};
}

std::string raw_samples() {
  return as_string(samples<std::int16_t>());
}

std::string nrrd_header(const std::string& encoding, const std::string& more = "") {
  return fmt::format(
      "NRRD0004\n# a ball\ntype: short\ndimension: 3\nsizes: {} {} {}\nencoding: {}\n"
      "endian: little\nspace: left-posterior-superior\n"
      "space directions: (1,0,0) (0,1.5,0) (0,0,2)\nspace origin: (1,2,3)\n"
      "space units: \"mm\" \"mm\" \"mm\"\n{}",
      size_x, size_y, size_z, encoding, more);
}

std::string meta_header(const std::string& more, const std::string& data) {
  return fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nDimSize = {} {} {}\n"
      "ElementType = MET_SHORT\nElementSpacing = 1 2 0.5\n{}ElementDataFile = {}\n",
      size_x, size_y, size_z, more, data);
}

template <class T>
void put_at(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::string nifti_header(int version, std::size_t data_at, bool single) {
  std::string h(version == 1 ? 348 : 540, '\0');
  if (single) h.resize(data_at, '\0');
  const int dims[8] = {3, size_x, size_y, size_z, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) {
    if (version == 1) {
      put_at(h, 40 + 2 * i, static_cast<std::int16_t>(dims[i]));
      put_at(h, 76 + 4 * i, 1.0F);
    } else {
      put_at(h, 16 + 8 * i, static_cast<std::int64_t>(dims[i]));
      put_at(h, 104 + 8 * i, 1.0);
    }
  }
  const bool first = version == 1;
  put_at(h, 0, first ? 348 : 540);
  put_at(h, first ? 70 : 12, std::int16_t{4});
  put_at(h, first ? 72 : 14, std::int16_t{16});
  if (first) {
    put_at(h, 108, single ? static_cast<float>(data_at) : 0.0F);
    put_at(h, 112, 1.0F);
    put_at(h, 123, std::uint8_t{2});
    std::memcpy(h.data() + 344, single ? "n+1" : "ni1", 4);
  } else {
    put_at(h, 168, static_cast<std::int64_t>(data_at));
    put_at(h, 176, 1.0);
    put_at(h, 500, 2);
    std::memcpy(h.data() + 4, "n+2\0\r\n\032\n", 8);
  }
  return h;
}

std::string inrimage_header() {
  std::string text = fmt::format(
      "#INRIMAGE-4#{{\nXDIM={}\nYDIM={}\nZDIM={}\nVDIM=1\nTYPE=signed fixed\nPIXSIZE=16 bits\n"
      "CPU=decm\nVX=1\nVY=2\nVZ=0.5\n",
      size_x, size_y, size_z);
  text.append((256 - (text.size() + 4) % 256) % 256, '\n');
  return text + "##}\n";
}

std::string mrc_header() {
  std::string h(1024, '\0');
  const int sides[3] = {size_x, size_y, size_z};
  for (std::size_t i = 0; i < 3; ++i) {
    put_at(h, 4 * i, sides[i]);
    put_at(h, 28 + 4 * i, sides[i]);
    put_at(h, 40 + 4 * i, 1.5F * static_cast<float>(sides[i]));
    put_at(h, 52 + 4 * i, 90.0F);
    put_at(h, 64 + 4 * i, static_cast<int>(i) + 1);
  }
  put_at(h, 12, 1);
  put_at(h, 88, 1);
  put_at(h, 108, 20140);
  std::memcpy(h.data() + 208, "MAP DD", 6);
  return h;
}

std::string amira_file(const std::string& place, const std::string& data) {
  return fmt::format(
      "# AmiraMesh BINARY-LITTLE-ENDIAN 2.1\n\ndefine Lattice {} {} {}\n\nParameters {{\n"
      "    Materials {{ Exterior {{ Id 1 }} Ball {{ Id 2 }} }}\n    BoundingBox 0 19 0 17 0 15,\n"
      "    CoordType \"uniform\"\n}}\n\nLattice {{ short Data }} {}\n\n# Data section follows\n"
      "@1\n{}\n",
      size_x, size_y, size_z, place, data);
}

// In runs of one byte, or of up to 100 others.
std::string byte_runs(const std::string& bytes) {
  std::string runs;
  for (std::size_t at = 0; at < bytes.size(); at += 100) {
    const std::string part = bytes.substr(at, 100);
    if (part.find_first_not_of(part[0]) == std::string::npos)
      runs += {static_cast<char>(part.size()), part[0]};
    else
      runs += static_cast<char>(128 + part.size()) + part;
  }
  return runs;
}

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

std::vector<TiffPage> tiff_pages() {
  std::vector<TiffPage> pages;
  for (int z = 0; z < size_z; ++z) {
    pages.push_back(tiff_page(size_x, size_y, SampleType::i16, samples<std::int16_t>(z, z + 1)));
    pages.back().deflate = z % 2 == 1;
    pages.back().strip_rows = z % 3 == 0 ? 5 : 0;
  }
  return pages;
}

// Slice z of the ball, 2 mm from the next.
DicomFile dicom_slice(int z) {
  DicomFile file = ct_slice({.columns = size_x, .rows = size_y, .z = 2.0 * z, .instance = z + 1});
  file.text(0x00281052, "DS", "0");
  return file.raw(0x7fe00010, "OW", as_string(samples<std::int16_t>(z, z + 1)));
}

// All of them as the frames of one file.
DicomFile dicom_frames() {
  DicomFile file = dicom_slice(0);
  file.text(0x00180088, "DS", "2").text(0x00280008, "IS", std::to_string(size_z));
  return file.raw(0x7fe00010, "OW", raw_samples());
}

// Run lengths of a slice, none of them a run of more than one value.
std::string dicom_runs(int z) {
  const std::vector<std::int16_t> values = samples<std::int16_t>(z, z + 1);
  std::string planes[2];
  for (std::size_t p = 0; p < 2; ++p)
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % 128 == 0)
        planes[p] += static_cast<char>(std::min<std::size_t>(128, values.size() - i) - 1);
      planes[p] += static_cast<char>(values[i] >> (p == 0 ? 8 : 0));
    }
  std::string header(64, '\0');
  put_at(header, 0, std::uint32_t{2});
  put_at(header, 4, std::uint32_t{64});
  put_at(header, 8, static_cast<std::uint32_t>(64 + planes[0].size()));
  return header + planes[0] + planes[1];
}

std::string ome_text() {
  return fmt::format(
      "<?xml version=\"1.0\"?><OME UUID=\"urn:uuid:1\"><Image ID=\"Image:0\" Name=\"a\"><Pixels "
      "DimensionOrder=\"XYZCT\" Type=\"int16\" SizeX=\"{}\" SizeY=\"{}\" SizeZ=\"{}\" SizeC=\"1\" "
      "SizeT=\"1\" PhysicalSizeX=\"1\" PhysicalSizeY=\"1\" PhysicalSizeZ=\"2\"><TiffData IFD=\"0\" "
      "PlaneCount=\"{}\"/></Pixels></Image></OME>",
      size_x, size_y, size_z, size_z);
}

class VolumeWriter {
 public:
  explicit VolumeWriter(const fs::path& root) : root_(root) {}

  // A specimen of these files; the config reads the first. More lines of [input] may be needed.
  void add(const std::string& name, const std::vector<std::pair<std::string, std::string>>& files,
           const std::string& input_lines = "") {
    Specimen specimen = begin(name);
    for (const auto& [file, bytes] : files) {
      fs::create_directories((specimen.folder / file).parent_path());
      write_bytes(specimen.folder / file, bytes);
      specimen.targets.push_back(file);
    }
    finish(std::move(specimen), files.front().first, input_lines);
  }
  Specimen begin(const std::string& name) const {
    Specimen specimen;
    specimen.name = name;
    specimen.folder = root_ / name;
    fs::create_directories(specimen.folder);
    return specimen;
  }
  // All files but the config may be changed where none is named.
  void finish(Specimen specimen, const std::string& input, const std::string& input_lines = "") {
    if (specimen.targets.empty())
      for (const auto& entry : fs::recursive_directory_iterator(specimen.folder))
        if (entry.is_regular_file())
          specimen.targets.push_back(fs::relative(entry.path(), specimen.folder).string());
    std::sort(specimen.targets.begin(), specimen.targets.end());
    write_bytes(specimen.folder / "case.toml",
                fmt::format("[input]\npath = \"{}\"\n{}[surface]\nisovalue = 100\n[work]\nbrick = "
                            "16\nshard = 2\nchunk = 16\n[run]\nthreads = 2\nmemory = \"256MiB\"\n",
                            input, input_lines));
    specimen.commands = {{"info", input},
                         {"info", input, "--check"},
                         {"info", input, "--histogram", "--json"},
                         {"init", input, "-o", "new.toml"},
                         {"run", "case.toml"},
                         {"run", "case.toml", "--set", "work.copy=true"},
                         {"run", "case.toml", "--dry-run"},
                         {"plan", "case.toml"}};
    if (specimen.name == "raw")
      for (Words& words : specimen.commands)
        if (words.front() == "info" || words.front() == "init")
          words.insert(words.begin() + 2, {"--size", "20", "18", "16", "--type", "int16"});
    all_.push_back(std::move(specimen));
  }
  std::vector<Specimen> take() { return std::move(all_); }

 private:
  fs::path root_;
  std::vector<Specimen> all_;
};

}  // namespace

std::vector<Specimen> write_volumes(const fs::path& program, const fs::path& root) {
  VolumeWriter to(root);
  const std::string raw = raw_samples(), nl = "\n";
  std::string text;
  for (const std::int16_t value : samples<std::int16_t>()) text += fmt::format("{} ", value);
  to.add("nrrd-raw", {{"v.nrrd", nrrd_header("raw") + nl + raw}});
  to.add("nrrd-gzip", {{"v.nrrd", nrrd_header("gzip") + nl + packed(raw)}});
  to.add("nrrd-ascii", {{"v.nrrd", nrrd_header("ascii") + nl + text}});
  to.add("nrrd-detached", {{"v.nhdr", nrrd_header("raw", "data file: v.raw\n")}, {"v.raw", raw}});
  std::vector<std::pair<std::string, std::string>> slices = {{"v.nhdr", ""}};
  std::string list = "data file: LIST\n";
  for (int z = 0; z < size_z; ++z) {
    slices.emplace_back(fmt::format("{}.raw", z), as_string(samples<std::int16_t>(z, z + 1)));
    list += slices.back().first + nl;
  }
  slices.front().second = nrrd_header("raw", list);
  to.add("nrrd-list", slices);
  to.add("metaimage", {{"v.mha", meta_header("", "LOCAL") + raw}});
  const std::string deflated_raw = packed(raw, Wrapper::zlib);
  to.add("metaimage-packed",
         {{"v.mha", meta_header(fmt::format("CompressedData = True\nCompressedDataSize = {}\n",
                                            deflated_raw.size()),
                                "LOCAL") +
                        deflated_raw}});
  to.add("metaimage-detached", {{"v.mhd", meta_header("", "v.raw")}, {"v.raw", raw}});
  to.add("nifti1", {{"v.nii", nifti_header(1, 352, true) + raw}});
  to.add("nifti1-gzip", {{"v.nii.gz", packed(nifti_header(1, 352, true) + raw)}});
  to.add("nifti1-pair", {{"v.hdr", nifti_header(1, 0, false)}, {"v.img", raw}});
  to.add("nifti2", {{"v.nii", nifti_header(2, 544, true) + raw}});
  to.add("nifti2-gzip", {{"v.nii.gz", packed(nifti_header(2, 544, true) + raw)}});
  to.add("inrimage", {{"v.inr", inrimage_header() + raw}});
  to.add("inrimage-gzip", {{"v.inr.gz", packed(inrimage_header() + raw)}});
  to.add("mrc", {{"v.mrc", mrc_header() + raw}});
  std::string mrc = mrc_header();
  put_at(mrc, 64, 3);
  put_at(mrc, 72, 1);
  to.add("mrc-turned", {{"v.map", mrc + raw}});
  to.add("mrc-gzip", {{"v.mrc.gz", packed(mrc_header() + raw)}});
  to.add("amira", {{"v.am", amira_file("@1", raw)}});
  const std::string runs = byte_runs(raw);
  to.add("amira-runs", {{"v.am", amira_file(fmt::format("@1(HxByteRLE,{})", runs.size()), runs)}});
  to.add("amira-zip",
         {{"v.am", amira_file(fmt::format("@1(HxZip,{})", deflated_raw.size()), deflated_raw)}});
  to.add("raw", {{"v.raw", raw}},
         fmt::format("format = \"raw\"\nsize = [{}, {}, {}]\ntype = \"int16\"\n", size_x, size_y,
                     size_z));
  for (const SmallFile& file : vtk_files({size_x, size_y, size_z}, raw, text))
    to.add(file.name, {{file.path, file.bytes}});
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
  Specimen sharded = to.begin("zarr-sharded");
  const ProcessEnd made = run_watched(
      {program.string(), "phantom", "sphere", "--size", "20", "--type", "uint8", "-o", "v.zarr"},
      sharded.folder, root / "made");
  if (made.exit_code != 0) throw std::runtime_error(made.err);
  to.finish(std::move(sharded), "v.zarr");
#ifdef VOXWELD_HDF5
  Specimen hdf5 = to.begin("hdf5");
  write_hdf5(hdf5.folder / "v.h5");
  to.finish(std::move(hdf5), "v.h5");
#endif
  Specimen tiff = to.begin("tiff");
  write_tiff(tiff.folder / "v.tif", tiff_pages());
  to.finish(std::move(tiff), "v.tif", "spacing = 1\n");
  Specimen big = to.begin("tiff-big");
  write_tiff(big.folder / "v.tif", tiff_pages(), true);
  to.finish(std::move(big), "v.tif", "spacing = 1\n");
  std::vector<TiffPage> pages_told = tiff_pages();
  pages_told[0].description = ome_text();
  Specimen ome = to.begin("tiff-ome");
  write_tiff(ome.folder / "v.tif", pages_told);
  to.finish(std::move(ome), "v.tif");
  pages_told[0].description =
      fmt::format("ImageJ=1.53t\nimages={}\nslices={}\nunit=um\nspacing=2\n", size_z, size_z);
  Specimen imagej = to.begin("tiff-imagej");
  write_tiff(imagej.folder / "v.tif", pages_told);
  to.finish(std::move(imagej), "v.tif");
  Specimen stack = to.begin("stack");
  fs::create_directory(stack.folder / "v");
  const std::vector<TiffPage> pages = tiff_pages();
  for (std::size_t z = 0; z < pages.size(); ++z)
    write_tiff(stack.folder / "v" / fmt::format("slice{:02}.tif", z), {pages[z]});
  to.finish(std::move(stack), "v", "spacing = 1\n");
  Specimen dicom = to.begin("dicom");
  fs::create_directory(dicom.folder / "v");
  for (int z = 0; z < size_z; ++z)
    write_bytes(dicom.folder / "v" / fmt::format("I{}", (5 * z + 3) % size_z),
                dicom_slice(z).bytes(z % 2 == 0 ? explicit_little : implicit_little));
  to.finish(std::move(dicom), "v");
  to.add("dicom-frames", {{"v.dcm", dicom_frames().bytes()}});
  std::vector<std::string> runs;
  for (int z = 0; z < size_z; ++z) runs.push_back(dicom_runs(z));
  DicomForm rle;
  rle.syntax = "1.2.840.10008.1.2.5";
  to.add("dicom-rle", {{"v.dcm", dicom_frames().fragments(runs).bytes(rle)}});
  DicomForm deflated_form;
  deflated_form.syntax = "1.2.840.10008.1.2.1.99";
  const std::string plain = dicom_frames().bytes(deflated_form);
  const std::size_t meta = DicomFile().bytes(deflated_form).size();
  // A zlib stream without its head and checksum.
  const std::string stream = packed(plain.substr(meta), Wrapper::zlib);
  to.add("dicom-deflated",
         {{"v.dcm", plain.substr(0, meta) + stream.substr(2, stream.size() - 6)}});
  Specimen greymaps = to.begin("stack-pgm");
  fs::create_directory(greymaps.folder / "v");
  for (int z = 0; z < size_z; ++z)
    write_bytes(greymaps.folder / "v" / fmt::format("{:02}.pgm", z),
                fmt::format("P5\n{} {}\n255\n", size_x, size_y) +
                    as_string(samples<std::uint8_t>(z, z + 1)));
  to.finish(std::move(greymaps), "v", "spacing = 1\n");
  return to.take();
}

}  // namespace voxweld::testing
