#include "pipeline/ingest/open_input.h"

#include "storage/image/stack_source.h"
#include "storage/readers/open_volume.h"
#include "storage/store/open_zarr.h"
#include "storage/volumes/empty_source.h"

namespace voxweld {
namespace {

bool has_image_extension(const std::string& extension) {
  for (const char* known :
       {".tif", ".tiff", ".png", ".bmp", ".jpg", ".jpeg", ".exr", ".pgm", ".jp2", ".tga"})
    if (extension == known) return true;
  return false;
}

Match sniff_zarr(const InputProbe& probe) {
  if (!probe.is_directory) return Match::none;
  for (const char* name : {"zarr.json", ".zarray", ".zgroup"})
    if (std::filesystem::exists(probe.path / name)) return Match::contents;
  return probe.extension == ".zarr" ? Match::extension : Match::none;
}

// A directory that is nothing else, a pattern, or an image by its name.
Match sniff_stack(const InputProbe& probe) {
  if (probe.is_directory) return Match::extension;
  const bool pattern = probe.path.string().find_first_of("*?[") != std::string::npos;
  return pattern || has_image_extension(probe.extension) ? Match::extension : Match::none;
}

}  // namespace

std::vector<ReaderEntry> all_readers() {
  std::vector<ReaderEntry> readers = builtin_readers();
  readers.push_back({"zarr", "a Zarr v3 directory", sniff_zarr,
                     [](const InputSpec& spec) { return open_zarr(spec.path); }});
  readers.push_back({"stack", "a folder or pattern of images, a multi-page .tif", sniff_stack,
                     [](const InputSpec& spec) {
                       return open_stack({spec.path, spec.spacing, spec.unit});
                     }});
  return readers;
}

std::shared_ptr<MeshVolume> open_mesh(const Config& config) {
  return config.input.format == InputConfig::Format::mesh ? open_mesh_input(config) : nullptr;
}

std::shared_ptr<SampleSource> open_input(const Config& whole) {
  const InputConfig& config = whole.input;
  if (auto mesh = open_mesh(whole)) return mesh;
  if (config.format == InputConfig::Format::empty) {
    VolumeGeometry geometry;
    geometry.size = config.size.value();
    if (config.spacing) geometry.spacing = *config.spacing;
    geometry.unit = config.unit;
    return empty_source(geometry);
  }
  static constexpr std::array formats = {"auto",     "nrrd", "metaimage", "nifti",
                                         "inrimage", "raw",  "stack",     "zarr"};
  InputSpec spec;
  spec.path = config.path.string();
  spec.format = formats[static_cast<std::size_t>(config.format)];
  spec.raw.size = config.size;
  spec.raw.type = config.type;
  spec.raw.byte_order =
      config.endian == InputConfig::Endian::little ? std::endian::little : std::endian::big;
  spec.raw.header_bytes = config.header_bytes;
  spec.crop = config.crop;
  spec.spacing = config.spacing;
  spec.unit = config.unit;
  return open_volume(spec, all_readers());
}

}  // namespace voxweld
