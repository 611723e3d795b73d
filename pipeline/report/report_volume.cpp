#include "pipeline/report/report_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

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

// The config and, where a filter goes by the isovalue and it may have been chosen, those that left it
// to a rule: the manifest has the number, and the copy in the work directory is the rule's.
std::vector<Config> as_asked(const Config& config) {
  std::vector<Config> configs = {config};
  if (!config.surface.isovalue || std::ranges::none_of(config.filters, &FilterConfig::is_global))
    return configs;
  for (const IsovalueRule rule : {IsovalueRule::otsu, IsovalueRule::valley}) {
    configs.push_back(config);
    configs.back().surface.isovalue.reset();
    configs.back().surface.isovalue_rule = rule;
  }
  return configs;
}

bool has_copy(const Config& config, const IngestJob& job) {
  return job.copy && ingest_stage(config, job)->look({}).missing.empty();
}

// Where the samples can be read from; null where that is gone: filters that have to see the whole
// volume first, and those behind a copy, read what ingest left.
std::shared_ptr<const SampleSource> source_of(const Config& config, const IngestJob& job) {
  if (has_copy(config, job)) return ingested_volume(config, job).source;
  return job.earlier.empty() && !job.pieces ? job.input : nullptr;
}

VolumeLook look(const Manifest& manifest, const Config& config, const SampleRequest& request,
                const IngestJob& job, const SampleSource& source) {
  const VolumeInfo& info = source.info();
  if (info.geometry.size != manifest.frame.size)
    throw InputError(fmt::format("{}: has {} x {} x {} samples, and the mesh is of {} x {} x {}",
                                 config.input.path.string(), info.geometry.size.x,
                                 info.geometry.size.y, info.geometry.size.z, manifest.frame.size.x,
                                 manifest.frame.size.y, manifest.frame.size.z));
  return {info, look_at_samples(source, request), job.info.warnings};
}

}  // namespace

std::string why_no_volume(const Manifest& manifest, const Config& config) {
  if (config.input.is_mesh()) return "The input is a mesh and not a volume.";
  if (config.input.is_empty()) return "There is no volume: the surface is made of solids alone.";
  if (manifest.input == nullptr) return {};
  return why_no_file(manifest.input->value("files", json::array()));
}

VolumeLook look_at_volume(const Manifest& manifest, const Config& config, SampleRequest request) {
  request.labels = is_of_labels(config);
  for (const Config& one : as_asked(config)) {
    const Jobs jobs(one, request.interrupt);
    if (const auto source = source_of(one, jobs.ingest()))
      return look(manifest, one, request, jobs.ingest(), *source);
  }
  throw InputError(fmt::format("{}: the filtered copy of it in {} is gone",
                               config.input.path.string(), config.work.directory.string()));
}

}  // namespace voxweld
