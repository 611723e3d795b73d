#include "pipeline/ingest/open_input.h"

#include "storage/readers/open_volume.h"
#include "storage/volumes/filters.h"

namespace voxweld {
namespace {

InputSpec spec_of(const InputConfig& config) {
  InputSpec spec;
  spec.path = config.path.string();
  spec.format = config.format;
  spec.raw.size = config.size;
  spec.raw.type = config.type;
  spec.raw.byte_order =
      config.endian == InputConfig::Endian::little ? std::endian::little : std::endian::big;
  spec.raw.header_bytes = config.header_bytes;
  spec.crop = config.crop;
  spec.spacing = config.spacing;
  spec.unit = config.unit;
  spec.follow = config.follow;
  spec.select = config.select;
  spec.resample = config.resample;
  return spec;
}

}  // namespace

std::shared_ptr<MeshVolume> open_mesh(const Config& config) {
  return config.input.is_mesh() ? open_mesh_input(config) : nullptr;
}

std::shared_ptr<SampleSource> open_input(const Config& whole) {
  const InputConfig& config = whole.input;
  if (auto mesh = open_mesh(whole)) return mesh;
  if (!config.is_empty()) return open_volume(spec_of(config));
  VolumeGeometry geometry;
  geometry.size = config.size.value();
  if (config.spacing) geometry.spacing = *config.spacing;
  geometry.unit = config.unit;
  return empty_source(geometry);
}

}  // namespace voxweld
