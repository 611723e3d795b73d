// Volumes in every format that is read.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/specimens.h"
#include "tests/storage/image/tiff_writer.h"
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

std::vector<TiffPage> tiff_pages() {
  std::vector<TiffPage> pages;
  for (int z = 0; z < size_z; ++z) {
    pages.push_back(tiff_page(size_x, size_y, SampleType::i16, samples<std::int16_t>(z, z + 1)));
    pages.back().deflate = z % 2 == 1;
    pages.back().strip_rows = z % 3 == 0 ? 5 : 0;
  }
  return pages;
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
  to.add("raw", {{"v.raw", raw}},
         fmt::format("format = \"raw\"\nsize = [{}, {}, {}]\ntype = \"int16\"\n", size_x, size_y,
                     size_z));
  Specimen zarr = to.begin("zarr");
  write_zarr(zarr.folder / "v.zarr");
  to.finish(std::move(zarr), "v.zarr");
  Specimen ome_zarr = to.begin("zarr-ome");
  write_ome_zarr(ome_zarr.folder / "v.zarr");
  to.finish(std::move(ome_zarr), "v.zarr");
  Specimen sharded = to.begin("zarr-sharded");
  const ProcessEnd made = run_watched(
      {program.string(), "phantom", "sphere", "--size", "20", "--type", "uint8", "-o", "v.zarr"},
      sharded.folder, root / "made");
  if (made.exit_code != 0) throw std::runtime_error(made.err);
  to.finish(std::move(sharded), "v.zarr");
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
