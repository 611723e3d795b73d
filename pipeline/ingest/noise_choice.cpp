#include "pipeline/ingest/noise_choice.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/stage/file_layout.h"
#include "stages/contouring/stored_surface.h"
#include "stages/ingest/noise_level.h"
#include "storage/artifact/noise_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::int64_t cube = 32;                          // samples a side: a chunk of most stores
constexpr std::int64_t fewest_cubes = 4, most_cubes = 16;  // a side
constexpr std::uint64_t enough_steps = 4096;

// Raised with every change of what is measured.
constexpr std::uint32_t measure_version = 1;

// f(box) of cubes spread evenly over the volume, at most so many a side.
template <class F>
void each_cube(Index3 size, std::int64_t most, const F& f) {
  Index3 cubes, taken;
  for (int a = 0; a < 3; ++a) {
    cubes[a] = (size[a] + cube - 1) / cube;
    taken[a] = std::min(cubes[a], most);
  }
  each_index(taken, [&](Index3 i) {
    Index3 lo;
    for (int a = 0; a < 3; ++a) lo[a] = (2 * i[a] + 1) * cubes[a] / (2 * taken[a]) * cube;
    f(intersect({lo, lo + splat(cube)}, {{}, size}));
  });
}

NoiseMeter meter_of(const SampleSource& source, const Isovalue& isovalue, std::int64_t most) {
  const VolumeInfo& info = source.info();
  NoiseMeter meter(info.type, isovalue);
  std::vector<std::byte> samples;
  each_cube(info.geometry.size, most, [&](const Box3& box) {
    samples.resize(static_cast<std::size_t>(box.count()) * sample_bytes(info.type));
    source.read(box, samples.data());
    meter.add(box.size(), samples.data());
  });
  return meter;
}

// Of the surface that noise is measured around.
Hash128 surface_hash(const Config& config) {
  return KeyHasher()
      .text("noise")
      .integer(measure_version)
      .text(isovalue_text(config.surface.isovalue.value()))
      .finish();
}

std::filesystem::path path_of(const Config& config, const IngestJob& job) {
  return job.folder / ("noise-" + short_hex(surface_hash(config)));
}

// Of a volume of files that nobody lists, those that were looked at count.
Hash128 key_of(const Config& config, const IngestJob& job, std::int64_t most) {
  KeyHasher key;
  key.hash(surface_hash(config)).hash(job.stamp).integer(most);
  if (lies_in_unlisted_files(job))
    each_cube(job.info.geometry.size, most,
              [&](const Box3& box) { key.hash(box_stamp(job, box)); });
  return key.finish();
}

std::optional<double> known_noise(const Config& config, const IngestJob& job) {
  const std::filesystem::path path = path_of(config, job);
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const NoiseArtifact artifact = read_noise_artifact(path);
    const auto most = static_cast<std::int64_t>(artifact.places);
    if (most >= fewest_cubes && most <= most_cubes && artifact.key == key_of(config, job, most))
      return artifact.level;
  } catch (const DamagedArtifact&) {  // it is measured again
  }
  return std::nullopt;
}

}  // namespace

bool asks_for_noise(const Config& config) {
  return config.surface.gradient == SurfaceConfig::Gradient::automatic && !config.surface.label &&
         config.labels.mode == LabelMode::off && config.input.has_samples();
}

bool noise_is_known(const Config& config, const IngestJob& job) {
  return known_noise(config, job).has_value();
}

VolumeNoise measure_noise(const SampleSource& source, const Isovalue& stored_isovalue) {
  std::int64_t most = fewest_cubes;
  NoiseMeter meter = meter_of(source, stored_isovalue, most);
  while (meter.count() < enough_steps && most < most_cubes)
    meter = meter_of(source, stored_isovalue, most *= 2);
  return {meter.level(), most};
}

namespace {

VolumeNoise noise_of_input(const Config& config, const IngestJob& job) {
  const Volume volume = ingested_volume(config, job);
  const SampleSource& source = *volume.source;
  SurfaceParameters surface;
  surface.isovalue = config.surface.isovalue.value();
  to_stored(surface, source.info().scale, source.info().type);
  return measure_noise(source, surface.isovalue);
}

}  // namespace

double choose_noise(const Config& config, const IngestJob& job) {
  if (const auto known = known_noise(config, job)) return *known;
  const VolumeNoise noise = noise_of_input(config, job);
  write_noise_artifact(path_of(config, job), {key_of(config, job, noise.places), noise.level,
                                              static_cast<std::uint64_t>(noise.places)});
  return noise.level;
}

}  // namespace voxweld
