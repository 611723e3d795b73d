#include "storage/store/open_zarr.h"

#include <algorithm>

#include "storage/store/chunk_reader.h"
#include "storage/store/foreign_array.h"
#include "storage/store/zip_store.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"
#include "storage/types/chunked_access.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

class ForeignArraySource final : public SampleSource {
 public:
  ForeignArraySource(ForeignArray found, const char* format)
      : reader_(std::move(found.array), found.folder, Ownership::theirs) {
    const ZarrArray& array = reader_.array();
    const std::string metadata = (array.path / array.metadata).string();
    info_.format = format;
    info_.type = array.type;
    info_.scale = array.scale;
    info_.files.push_back(found.folder.input_file(array.metadata));
    info_.choices = std::move(found.choices);
    info_.warnings = std::move(found.warnings);
    if (array.geometry)
      info_.geometry = *array.geometry;
    else
      info_.warnings.push_back(metadata +
                               ": says no spacing; 1 x 1 x 1 is assumed, set it in the config");
    info_.geometry.size = array.size;
    for (int axis = 0; axis < 3; ++axis)
      info_.geometry.spacing[axis] = sound_spacing(info_.geometry.spacing[axis], metadata, info_);
    info_.chunk = min(array.axes_of(array.chunk), array.size);
    info_.access = chunked_access(array.size, info_.chunk);
    info_.largest_decode = reader_.largest_decode();
    info_.piece_files = array.files();
    if (array.half) info_.warnings.push_back(metadata + ": 16-bit floats are widened to 32 bits");
    if (std::ranges::find(array.axes, 2) == array.axes.end())
      info_.warnings.push_back(metadata + ": has two dimensions; read as a volume of one slice");
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

std::unique_ptr<SampleSource> open_array(const InputSpec& spec, ArrayFamily family) {
  return std::make_unique<ForeignArraySource>(find_foreign_array(spec, family),
                                              family == ArrayFamily::n5 ? "n5" : "zarr");
}

// Whether a zip file holds metadata of one of these names, at any depth.
bool zip_holds(const InputProbe& probe, std::initializer_list<std::string> names) {
  if (!probe.is_file || !looks_zip(probe.head)) return false;
  try {
    for (const std::string& key : zip_member_names(probe.path))
      for (const std::string& name : names)
        if (key == name || key.ends_with('/' + name)) return true;
  } catch (const FormatError&) {
    // Damaged: the reader that its name leads to says so.
  }
  return false;
}

bool folder_holds(const InputProbe& probe, std::initializer_list<std::string> names) {
  std::error_code ignored;
  return probe.is_directory && std::ranges::any_of(names, [&](const std::string& name) {
           return fs::exists(probe.path / name, ignored);
         });
}

// Whether the server has metadata of one of these names at the address.
bool server_holds(const InputProbe& probe, std::initializer_list<std::string> names) {
  const std::string path = probe.path.string();
  if (!is_url(path)) return false;
  const auto store = open_byte_store(path);
  return std::ranges::any_of(names, [&](const std::string& name) { return store->holds(name); });
}

Match test_zarr(const InputProbe& probe) {
  const std::initializer_list<std::string> names{"zarr.json", ".zarray", ".zgroup"};
  if (folder_holds(probe, names) || zip_holds(probe, names) || server_holds(probe, names))
    return Match::contents;
  const std::string name = probe.path.filename().string();
  const bool named = (probe.is_directory && probe.extension == ".zarr") ||
                     (probe.is_file && (probe.extension == ".ozx" || name.ends_with(".zarr.zip")));
  return named ? Match::extension : Match::none;
}

// Other programs leave an attributes.json too.
bool speaks_of_n5(const fs::path& file) {
  constexpr std::uint64_t most = std::uint64_t{1} << 20;
  std::error_code none;
  const auto size = fs::file_size(file, none);
  if (none || size > most || !fs::is_regular_file(file, none)) return false;
  const std::string text = read_text_file(file);
  for (const char* key : {"\"dimensions\"", "\"n5\"", "\"downsamplingFactors\"", "\"multiScale\""})
    if (text.find(key) != std::string::npos) return true;
  return false;
}

Match test_n5(const InputProbe& probe) {
  const std::string metadata = "attributes.json";
  if (folder_holds(probe, {"s0/" + metadata}) || zip_holds(probe, {metadata}) ||
      server_holds(probe, {metadata}) ||
      (probe.is_directory && speaks_of_n5(probe.path / metadata)))
    return Match::contents;
  const std::string name = probe.path.filename().string();
  const bool named = (probe.is_directory && probe.extension == ".n5") ||
                     (probe.is_file && name.ends_with(".n5.zip"));
  return named ? Match::extension : Match::none;
}

const std::vector<Selector> array_selectors{Selector::dataset, Selector::level, Selector::channel,
                                            Selector::time};

}  // namespace

std::unique_ptr<SampleSource> open_zarr(const fs::path& directory) {
  return open_array({.path = directory.string()}, ArrayFamily::zarr);
}

VolumeReader zarr_reader() {
  return {.name = "zarr",
          .files = "a Zarr directory, .zarr.zip, .ozx",
          .test = test_zarr,
          .open = [](const InputSpec& spec) { return open_array(spec, ArrayFamily::zarr); },
          .selects = array_selectors};
}

VolumeReader n5_reader() {
  return {.name = "n5",
          .files = "an N5 directory, .n5.zip",
          .test = test_n5,
          .open = [](const InputSpec& spec) { return open_array(spec, ArrayFamily::n5); },
          .selects = array_selectors};
}

}  // namespace voxweld
