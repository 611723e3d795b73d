// Folders of slices that the tests write, and the comparison of what is read from them.
#pragma once

#include <fmt/format.h>

#include "tests/storage/dicom/dicom_writer.h"
#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {

// Of Access::slice: in any order, in bands of rows.
inline void expect_slices(const SampleSource& source, const KnownVolume& volume) {
  const VolumeInfo& info = source.info();
  ASSERT_EQ(info.geometry.size, volume.size);
  ASSERT_EQ(info.type, volume.type);
  ASSERT_EQ(info.access, Access::slice);
  EXPECT_EQ(info.format, "dicom");
  EXPECT_EQ(read_box(source, {{}, volume.size}), volume.samples);
  std::mt19937_64 random(7);
  for (int i = 0; i < 30; ++i) {
    Box3 box = random_box(volume.size, random);
    box.lo.x = 0;
    box.hi.x = volume.size.x;
    ASSERT_EQ(read_box(source, box), volume.box(box));
  }
}

// A CT of slices 2 mm apart, ready to be changed and written.
class DicomFolder : public VolumeFolder {
 public:
  explicit DicomFolder(Index3 size = {5, 4, 6}) : volume(make_volume(SampleType::i16, size)) {
    for (int z = 0; z < size.z; ++z) add(z, 2.0 * z);
  }

  // A slice with the samples of plane `plane`, at that height.
  DicomFile& add(int plane, double z) {
    const Index3 n = volume.size;
    DicomFile file = ct_slice({.columns = static_cast<int>(n.x),
                               .rows = static_cast<int>(n.y),
                               .x = -10,
                               .y = 20,
                               .z = z,
                               .instance = static_cast<int>(slices.size()) + 1});
    const Bytes samples = volume.box({{0, 0, plane}, {n.x, n.y, plane + 1}});
    file.raw(0x7fe00010, "OW", {reinterpret_cast<const char*>(samples.data()), samples.size()});
    slices.push_back(std::move(file));
    return slices.back();
  }
  std::filesystem::path path() const { return *this / "scan"; }
  std::filesystem::path file(std::size_t i) const { return path() / fmt::format("I{}", i); }
  // Names tell nothing of the order.
  void write(const DicomForm& form = explicit_little) const {
    std::filesystem::remove_all(path());
    const std::size_t apart = slices.size() % 5 == 0 ? 100 : 0;  // else two would have one name
    for (std::size_t i = 0; i < slices.size(); ++i)
      write_file(file((i * 5 + 3) % slices.size() + apart * i), slices[i].bytes(form));
  }
  std::unique_ptr<SampleSource> opened(InputSpec spec = {}) const {
    write();
    spec.path = path().string();
    return open_volume(spec);
  }
  std::string said(InputSpec spec = {}) const {
    write();
    spec.path = path().string();
    return testing::complaint(spec);
  }

  KnownVolume volume;
  std::vector<DicomFile> slices;
};

inline std::string warnings_of(const SampleSource& source) {
  std::string all;
  for (const std::string& warning : source.info().warnings) all += warning + "\n";
  return all;
}

}  // namespace voxweld::testing
