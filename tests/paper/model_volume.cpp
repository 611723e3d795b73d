#include "tests/paper/model_volume.h"

#include <bit>

#include "pipeline/build/contour_parameters.h"
#include "pipeline/ingest/label_choice.h"
#include "pipeline/ingest/open_input.h"
#include "storage/support/error.h"

namespace voxweld::paper {

ContourOptions ModelVolume::options() const {
  return {std::countr_zero(static_cast<std::uint64_t>(config.work.brick)),
          static_cast<std::uint64_t>(config.output.tile_vertices), config.output.precision};
}

HaloBlock ModelVolume::block() const {
  return {volume.type,           volume.size,   {{}, volume.size},
          volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
}

ModelVolume load_model(const std::filesystem::path& config,
                       std::span<const std::string> overrides) {
  ModelVolume model;
  model.config = load_config(config, overrides);
  if (!model.config.surface.isovalue)
    throw InputError(config.string() + ": surface.isovalue has to be a number here");
  const auto mesh = open_mesh(model.config);
  const std::shared_ptr<SampleSource> source = mesh ? mesh : open_input(model.config);
  const VolumeInfo& info = source->info();
  std::optional<Solid> solid;
  if (mesh) solid = mesh->solid();
  model.parameters = contour_parameters(model.config, info, solid,
                                        chosen_labels(model.config, read_labels_map(model.config)));
  model.empty = model.config.input.is_empty();
  model.volume.type = info.type;
  model.volume.size = info.geometry.size;
  const Box3 all{{}, info.geometry.size};
  model.volume.samples.resize(static_cast<std::size_t>(all.count()) * sample_bytes(info.type));
  source->read(all, model.volume.samples.data());
  return model;
}

}  // namespace voxweld::paper
