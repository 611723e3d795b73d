#include <fmt/format.h>

#include "tests/fuzz/ball.h"
#include "tests/fuzz/volume_writer.h"
#include "tests/fuzz/vtk_specimens.h"

namespace voxweld::testing {
namespace {

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

}  // namespace

void write_files(VolumeWriter& to) {
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
}

}  // namespace voxweld::testing
