#include "storage/artifact/noise_artifact.h"

#include <cmath>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

enum NoiseSection : std::uint64_t { level_section = 1, places_section };

}  // namespace

void write_noise_artifact(const std::filesystem::path& path, const NoiseArtifact& artifact) {
  ArtifactWriter out(path, {noise_kind, noise_version, artifact.key});
  out.section(level_section, as_record(artifact.level));
  out.section(places_section, as_record(artifact.places));
  out.commit();
}

NoiseArtifact read_noise_artifact(const std::filesystem::path& path) {
  const ArtifactReader in(path, noise_kind, noise_version);
  const auto level = in.read_array<double>(level_section);
  const auto places = in.read_array<std::uint64_t>(places_section);
  if (level.size() != 1 || places.size() != 1 || !(level[0] >= 0) || !std::isfinite(level[0]))
    in.damaged("its level is no standard deviation");
  return {in.key(), level[0], places[0]};
}

}  // namespace voxweld
