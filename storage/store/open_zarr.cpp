#include "storage/store/open_zarr.h"

#include "storage/store/chunk_reader.h"
#include "storage/store/ome_zarr.h"
#include "storage/store/zarr_metadata.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

class ZarrSource final : public SampleSource {
 public:
  explicit ZarrSource(const ZarrArray& array) : reader_(array, Ownership::theirs) {
    const ReadFile metadata(array.path / array.metadata);
    info_.format = "zarr";
    info_.type = array.type;
    info_.scale = array.scale;
    info_.access = Access::box;
    info_.largest_decode = reader_.largest_decode();
    info_.files.push_back({metadata.path(), metadata.state()});
    if (array.geometry)
      info_.geometry = *array.geometry;
    else
      info_.warnings.push_back(metadata.path() +
                               ": says no spacing; 1 x 1 x 1 is assumed, set it in the config");
    info_.geometry.size = array.size;
    if (array.axes.size() == 2)
      info_.warnings.push_back(metadata.path() +
                               ": has two dimensions; read as a volume of one slice");
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override { reader_.read(box, out); }
  void each_file(const Box3& box, const FileVisitor& f) const override {
    reader_.each_file(box, f);
  }

 private:
  ChunkReader reader_;
  VolumeInfo info_;
};

Match test_zarr(const InputProbe& probe) {
  if (!probe.is_directory) return Match::none;
  for (const char* name : {"zarr.json", ".zarray", ".zgroup"})
    if (std::filesystem::exists(probe.path / name)) return Match::contents;
  return probe.extension == ".zarr" ? Match::extension : Match::none;
}

}  // namespace

std::unique_ptr<SampleSource> open_zarr(const std::filesystem::path& directory) {
  return std::make_unique<ZarrSource>(read_foreign_array(directory));
}

VolumeReader zarr_reader() {
  return {"zarr", "a Zarr directory", test_zarr,
          [](const InputSpec& spec) { return open_zarr(spec.path); }};
}

}  // namespace voxweld
