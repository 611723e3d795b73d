#include "pipeline/report/report_volume.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/ingest/ingest_stage.h"
#include "pipeline/run/jobs.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

using nlohmann::json;

// The first of the files that is not as the manifest has it.
std::string why_no_file(const json& files) {
  for (const json& file : files) {
    const std::string path = file.at("path");
    if (is_url(path)) continue;
    const auto state = file_state(path);
    if (!state) return fmt::format("The volume is gone: there is no {} any more.", path);
    if (state->size != file.at("bytes").get<std::uint64_t>() ||
        state->mtime_ns != file.at("modified_ns").get<std::int64_t>())
      return fmt::format("The volume has changed since the mesh was made of it: {}.", path);
  }
  return {};
}

std::shared_ptr<const SampleSource> source_of(const Config& config, const IngestJob& job) {
  if (job.copy && ingest_stage(config, job)->look({}).missing.empty())
    return ingested_volume(config, job).source;
  // Filters that have to see the whole volume first, and those behind a copy, read what is gone.
  if (!job.earlier.empty() || job.pieces || job.input == nullptr)
    throw InputError(fmt::format("{}: its copy in {} is gone", config.input.path.string(),
                                 config.work.directory.string()));
  return job.input;
}

}  // namespace

bool is_of_labels(const Config& config) {
  return config.surface.label || config.labels.mode != LabelMode::off;
}

std::string why_no_volume(const Manifest& manifest, const Config& config) {
  if (config.input.is_mesh()) return "The input is a mesh and not a volume.";
  if (config.input.is_empty()) return "There is no volume: the surface is made of solids alone.";
  if (manifest.input == nullptr) return {};
  return why_no_file(manifest.input->value("files", json::array()));
}

VolumeLook look_at_volume(const Manifest& manifest, const Config& config, SampleRequest request) {
  const Jobs jobs(config, request.interrupt);
  const auto source = source_of(config, jobs.ingest());
  const VolumeInfo& info = source->info();
  if (info.geometry.size != manifest.frame.size)
    throw InputError(fmt::format("{}: has {} x {} x {} samples, and the mesh is of {} x {} x {}",
                                 config.input.path.string(), info.geometry.size.x,
                                 info.geometry.size.y, info.geometry.size.z, manifest.frame.size.x,
                                 manifest.frame.size.y, manifest.frame.size.z));
  request.labels = is_of_labels(config);
  return {info, look_at_samples(*source, request), jobs.ingest().info.warnings};
}

}  // namespace voxweld
