// Volumes: opened as a run opens them, and some boxes read.
#include <algorithm>
#include <stdexcept>

#include "storage/readers/open_volume.h"
#include "storage/volumes/data_layout.h"
#include "tests/fuzz/coverage/entries.h"

namespace voxweld::testing {
namespace {

constexpr std::int64_t side = 12;
// What a run holds of one piece is planned by what the reader says: more than this is not asked for.
constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
constexpr std::uint64_t most_decode = std::uint64_t{64} << 20;

std::uint64_t bytes_of(const VolumeInfo& info, const Box3& box) {
  return static_cast<std::uint64_t>(box.count()) * sample_bytes(info.type);
}

void read_box(const SampleSource& source, const Box3& box) {
  std::vector<std::byte> samples(bytes_of(source.info(), box));
  source.read(box, samples.data());
}

// Boxes as Access allows them: anywhere, of whole rows, or of whole slices.
Box3 box_at(const VolumeInfo& info, std::int64_t eighth) {
  const Index3 size = info.geometry.size;
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t extent = std::min(a == 2 ? 2 : side, size[a]);
    box.lo[a] = (size[a] - extent) * eighth / 8;
    box.hi[a] = box.lo[a] + extent;
  }
  if (info.access == Access::box || info.access == Access::chunks) return box;
  box.lo.x = 0;
  box.hi.x = size.x;
  if (info.access == Access::rows) return box;
  box.lo.y = 0;
  box.hi.y = size.y;
  return box;
}

void read_some(const SampleSource& source) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  for (int a = 0; a < 3; ++a)
    if (size[a] < 1) throw std::logic_error("a volume without samples was opened");
  if (info.largest_decode > most_decode) return;
  // Streams are read forwards.
  for (const std::int64_t eighth : {0, 4, 8}) {
    const Box3 box = box_at(info, eighth);
    if (bytes_of(info, box) <= most_bytes) read_box(source, box);
  }
}

void parse_volume(const ParserEntry& entry, Bytes bytes) {
  InputSpec spec;
  spec.path = write_case(bytes, entry.ending).string();
  spec.format = entry.argument;
  spec.survey = true;
  read_some(*open_volume(spec));
  spec.survey = false;
  read_some(*open_volume(spec));
}

ParserEntry volume(const std::string& name, const std::string& ending, const std::string& format,
                   const std::string& module = {}) {
  return {name, ending, format, module, parse_volume};
}

}  // namespace

std::vector<ParserEntry> volume_entries() {
  return {volume("nrrd", ".nrrd", "nrrd"),
          volume("metaimage", ".mha", "metaimage"),
          volume("nifti", ".nii", "nifti"),
          volume("inrimage", ".inr", "inrimage"),
          volume("mrc", ".mrc", "mrc"),
          volume("amira", ".am", "amira"),
          volume("vti", ".vti", "vti"),
          volume("vtk", ".vtk", "vtk"),
          volume("zarr", ".zarr.zip", "zarr"),
          volume("n5", ".n5.zip", "n5"),
          volume("detect", ".dat", "auto"),
          volume("tiff", ".tif", "stack", "tiff"),
          volume("hdf5", ".h5", "hdf5", "hdf5"),
          volume("dicom", ".dcm", "dicom", "dicom"),
          volume("image", ".png", "stack", "image")};
}

}  // namespace voxweld::testing
