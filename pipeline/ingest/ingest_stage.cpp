#include "pipeline/ingest/ingest_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>

#include "pipeline/config/settings.h"
#include "pipeline/filter/filter_source.h"
#include "pipeline/ingest/filtered_input.h"
#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/mesh_ingest.h"
#include "pipeline/ingest/open_input.h"
#include "pipeline/ingest/recorded_input.h"
#include "pipeline/ingest/shard_ingest.h"
#include "pipeline/ingest/store_stamps.h"
#include "pipeline/ingest/volume_scan.h"
#include "pipeline/stage/artifacts.h"
#include "storage/artifact/histogram_artifact.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

// The input is read in place, and here at most for its histogram.
class InPlaceIngest final : public StageWork {
 public:
  explicit InPlaceIngest(const IngestJob& job) : job_(job) {}

  Stage stage() const override { return Stage::ingest; }
  std::string noun() const override { return "shards"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return 0; }
  std::vector<Unit> units(std::span<const std::uint64_t>) const override { return {}; }
  bool done(std::uint64_t) override { return true; }
  StageLook look(const UnitSelection&) override {
    StageLook look;
    look.rest = missing_besides(job_);
    return look;
  }
  std::string current_text() const override { return read_in_place_text; }
  StageMemory memory(std::span<const std::uint64_t>) override {
    return {"ingest", 0, 0, "the histogram", "raise run.memory"};
  }
  void run(const Unit&, WorkerContext&) override {}
  void open(RunContext& context, const StageLook& look) override {
    if (!look.current()) finish_earlier(context, job_);
  }
  void close(RunContext& context) override {
    if (makes_histogram(job_) && !histogram_is_current(job_))
      write_histogram_artifact(histogram_path(job_.folder),
                               {job_.stamp, scan_volume(context, *job_.input, "ingest").histogram});
  }

 private:
  const IngestJob& job_;
};

}  // namespace

bool histogram_is_current(const IngestJob& job) {
  if (!std::filesystem::exists(histogram_path(job.folder))) return false;
  try {
    return ArtifactReader(histogram_path(job.folder), histogram_kind, histogram_version).key() ==
           job.stamp;
  } catch (const DamagedArtifact&) {
    return false;
  }
}

bool makes_histogram(const IngestJob& job) {
  return job.histogram && !job.pieces;
}

std::string missing_besides(const IngestJob& job) {
  if (job.histogram && !histogram_is_current(histogram_job(job))) return "the histogram is missing";
  if (!job.copy && !earlier_is_current(job))
    return "what its filters need of the whole volume is missing";
  return "";
}

namespace {

// Those that are not in VolumeInfo::files.
std::vector<InputFile> files_besides(const Config& config) {
  std::vector<InputFile> files;
  const auto add = [&](const std::filesystem::path& path) {
    if (const auto state = path.empty() ? std::nullopt : file_state(path))
      files.push_back({path.string(), *state});
  };
  if (config.input.is_mesh()) add(config.input.path);
  if (config.labels.mode != LabelMode::off) add(config.labels.map);
  for (const EditConfig& edit : config.edits) add(edit.path);
  return files;
}

// Whether samples can be read where they lie.
bool open_plain(const Config& config, const std::filesystem::path& folder,
                const InterruptFlag* interrupt, IngestJob& job) {
  const auto known = recorded_input(folder, input_record_key(config));
  if (known) {
    job.info = *known;
  } else {
    if (streams_mesh(config)) job.mesh = plan_streamed_mesh(config, folder, interrupt);
    const auto mesh = job.mesh ? job.mesh->volume : open_mesh(config);
    if (mesh) job.solid = mesh->solid();
    job.input = mesh;
    if (!mesh) job.input = open_input(config);
    job.info = job.input->info();
    for (const std::string& warning : job.info.warnings) spdlog::warn("{}", warning);
  }
  const VolumeInfo& info = job.info;
  job.file_per_slice = info.access == Access::slice && !config.input.crop &&
                       static_cast<std::int64_t>(info.files.size()) == info.geometry.size.z;
  return !known && info.access == Access::box;
}

}  // namespace

IngestJob plan_ingest(const Config& config, const std::filesystem::path& folder,
                      const InterruptFlag* interrupt) {
  IngestJob job;
  bool by_box = false;
  if (config.filters.empty()) {
    by_box = open_plain(config, folder, interrupt, job);
  } else {
    job = plan_filtered(config, folder, interrupt);
    by_box = true;
  }
  job.folder = folder;
  const VolumeInfo& info = job.info;
  const std::vector<InputFile> besides = files_besides(config);
  job.files = info.files;
  job.files.insert(job.files.end(), besides.begin(), besides.end());
  check_coordinates(info.geometry,
                    config.input.path.empty() ? "input.spacing" : config.input.path.string());
  job.parameters = parameter_hash(config, Stage::ingest);
  job.stamp = files_stamp(job, 0, info.files.size());
  if (job.pieces) job.stamp = KeyHasher().hash(job.stamp).hash(job.pieces->key).finish();
  if (config.work.copy == WorkConfig::Copy::never && !by_box)
    throw InputError(
        fmt::format("work.copy = false: {} ({}) can be read by {} only, so a brick store is "
                    "needed; use work.copy = \"auto\"",
                    config.input.path.string(), info.format, access_name(info.access)));
  // Samples on a server are fetched once, not by every build.
  const bool far = is_url(config.input.path.string()) && config.filters.empty();
  const bool better = far || std::ranges::any_of(config.filters, std::not_fn(reads_through));
  job.copy = (config.work.copy == WorkConfig::Copy::always || !by_box ||
              (better && config.work.copy != WorkConfig::Copy::never)) &&
             config.input.has_samples();
  job.histogram = !config.surface.isovalue.has_value();
  job.labels = config.labels.mode != LabelMode::off;
  return job;
}

std::unique_ptr<StageWork> ingest_stage(const Config& config, const IngestJob& job) {
  if (job.mesh) return mesh_ingest(config, *job.mesh);
  if (job.by_shards()) return shard_ingest(config, job);
  return std::make_unique<InPlaceIngest>(job);
}

Volume ingested_volume(const Config& config, const IngestJob& job) {
  if (!job.copy)
    return {job.input, [&job](const Box3& samples) { return box_stamp(job, samples); }, job.solid};
  const StoreLayout layout = store_layout(config, job);
  const auto store = std::make_shared<StoreSource>(layout);
  return {store, [stamps = std::make_shared<StoreStamps>(layout)](const Box3& samples) {
            return stamps->of(samples);
          }};
}

std::optional<std::string> changed_file(const IngestJob& job) {
  for (const InputFile& file : job.files)
    // What a server holds is looked at when it is opened.
    if (!is_url(file.path) && file_state(file.path) != file.state) return file.path;
  return std::nullopt;
}

bool lies_in_unlisted_files(const IngestJob& job) {
  bool any = false;
  if (job.input)
    job.input->each_file({{}, splat(1)}, [&](const std::filesystem::path&) { any = true; });
  return any;
}

std::optional<Histogram> read_histogram(const IngestJob& job) {
  if (!histogram_is_current(job)) return std::nullopt;
  return read_histogram_artifact(histogram_path(job.folder)).histogram;
}

ValueRange whole_range(RunContext& context, const Volume& volume) {
  const Box3 all{{}, volume.geometry().size};
  const ValueRange stored = volume.ranges() != nullptr
                                ? volume.ranges()->range(all)
                                : scan_volume(context, *volume.source, "scan").range;
  return real_range(stored, volume.source->info().scale);
}

}  // namespace voxweld
