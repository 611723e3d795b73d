#include <fmt/format.h>

#include "tests/fuzz/ball.h"
#include "tests/fuzz/volume_writer.h"
#include "tests/storage/dicom/dicom_writer.h"
#include "tests/storage/image/tiff_writer.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

void write_images(VolumeWriter& to) {
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
  std::vector<std::string> frames;
  for (int z = 0; z < size_z; ++z) frames.push_back(dicom_runs(z));
  DicomForm rle;
  rle.syntax = "1.2.840.10008.1.2.5";
  to.add("dicom-rle", {{"v.dcm", dicom_frames().fragments(frames).bytes(rle)}});
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
}

}  // namespace voxweld::testing
