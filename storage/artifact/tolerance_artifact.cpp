#include "storage/artifact/tolerance_artifact.h"

#include <cmath>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

enum ToleranceSection : std::uint64_t { chosen_section = 1, sources_section };

}  // namespace

void write_tolerance_artifact(const std::filesystem::path& path,
                              const ToleranceArtifact& artifact) {
  ArtifactWriter out(path, {tolerance_kind, tolerance_version, artifact.key});
  out.section(chosen_section, as_record(artifact.chosen));
  out.section(sources_section, as_record(artifact.sources));
  out.commit();
}

ToleranceArtifact read_tolerance_artifact(const std::filesystem::path& path) {
  const ArtifactReader in(path, tolerance_kind, tolerance_version);
  ToleranceArtifact artifact{in.key(), {}, {}};
  artifact.chosen = in.read_record<ChosenTolerance>(chosen_section, "has no tolerance");
  artifact.sources = in.read_record<Hash128>(sources_section, "does not say of what it is");
  const ChosenTolerance& chosen = artifact.chosen;
  if (!std::isfinite(chosen.tolerance) || chosen.tolerance < 0 || chosen.reached > 1)
    in.damaged("its tolerance is none");
  return artifact;
}

}  // namespace voxweld
