#include "tests/paper/model_volume.h"

#include <bit>

#include "pipeline/labels/label_choice.h"
#include "pipeline/run/context.h"
#include "pipeline/run/open_input.h"
#include "storage/support/error.h"

namespace voxweld::paper {

testing::MemoryOptions ModelVolume::options() const {
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
  const auto source = open_input(model.config);
  const VolumeInfo& info = source->info();
  model.parameters = contour_parameters(model.config, *source,
                                        chosen_labels(model.config, read_labels_map(model.config)));
  model.empty = model.config.input.format == InputConfig::Format::empty;
  model.volume.type = info.type;
  model.volume.size = info.geometry.size;
  const Box3 all{{}, info.geometry.size};
  model.volume.samples.resize(static_cast<std::size_t>(all.count()) * sample_bytes(info.type));
  source->read(all, model.volume.samples.data());
  return model;
}

}  // namespace voxweld::paper
