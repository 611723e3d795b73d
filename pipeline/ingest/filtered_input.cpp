#include "pipeline/ingest/filtered_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "pipeline/config/settings.h"
#include "pipeline/filter/filter_source.h"
#include "pipeline/filter/pieces.h"
#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/isovalue_choice.h"
#include "pipeline/ingest/shard_ingest.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/units_here.h"
#include "pipeline/stage/work_claim.h"
#include "stages/contouring/stored_surface.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// What an earlier ingest leaves, to be read once it is done.
class LaterVolume final : public SampleSource {
 public:
  explicit LaterVolume(std::shared_ptr<const EarlierIngest> earlier)
      : earlier_(std::move(earlier)), info_(earlier_->job.info) {
    if (!earlier_->job.copy) return;
    info_ = read_by_any_box(info_);
    info_.largest_decode = store_decode_bytes(store_layout(earlier_->config, earlier_->job));
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    if (!earlier_->job.copy) return earlier_->job.input->read(box, out);
    std::call_once(opened_, [&] {
      store_ = std::make_unique<StoreSource>(store_layout(earlier_->config, earlier_->job));
    });
    store_->read(box, out);
  }

  // Those that the samples come from in the end: the store may not be there yet.
  void each_file(const Box3& box, const FileVisitor& f) const override {
    if (earlier_->job.input) earlier_->job.input->each_file(box, f);
  }

 private:
  std::shared_ptr<const EarlierIngest> earlier_;
  VolumeInfo info_;
  mutable std::once_flag opened_;
  mutable std::unique_ptr<StoreSource> store_;
};

// How many filters come before the first that is left to the job itself.
std::size_t filters_before(const std::vector<FilterConfig>& filters) {
  for (std::size_t i = filters.size(); i > 0; --i)
    if (filters[i - 1].is_global()) return i - 1;
  return 0;
}

// Samples alone: what is made of them is the later config's.
Config samples_of(Config config) {
  config.labels = {};
  config.edits.clear();
  config.surface.label.reset();
  // Every sample is read and copied once already.
  if (config.work.copy == WorkConfig::Copy::always) config.work.copy = WorkConfig::Copy::automatic;
  return config;
}

Config config_before(const Config& config, std::size_t filters) {
  Config before = samples_of(config);
  const bool asked = config.filters[filters].is_global();
  before.filters.resize(filters);
  if (!asked && !before.surface.isovalue) before.surface.isovalue = 0;  // no histogram
  return before;
}

Config config_of_mask(const Config& config, const FilterConfig& filter) {
  Config mask = samples_of(config);
  mask.input = {};
  mask.input.path = filter.path;
  mask.filters.clear();
  mask.surface.isovalue = 0;
  return mask;
}

std::shared_ptr<const EarlierIngest> plan_earlier(const Config& config,
                                                  const InterruptFlag* interrupt) {
  const auto folder = stage_paths(config, VolumeInfo{}, {}).ingest;
  return std::make_shared<EarlierIngest>(
      EarlierIngest{config, plan_ingest(config, folder, interrupt)});
}

// Adds the filter's mask to the job's earlier ingests, where it has one.
std::shared_ptr<SampleSource> plan_mask(const Config& config, std::size_t number,
                                        const InterruptFlag* interrupt, IngestJob& job) {
  const FilterConfig& filter = config.filters[number - 1];
  if (filter.type != FilterType::mask) return nullptr;
  try {
    job.earlier.push_back(plan_earlier(config_of_mask(config, filter), interrupt));
  } catch (const Error& error) {
    if (error.exit_code() != 2) throw;
    throw InputError(
        fmt::format("filter {}: the mask cannot be opened; its file has to hold one volume: {}",
                    number, error.what()));
  }
  return std::make_shared<LaterVolume>(job.earlier.back());
}

// Of everything that pieces are found in, and of the rule. They depend on all samples, wherever one
// reads.
Hash128 pieces_key(const Config& config, const EarlierIngest& before, const SampleSource& samples) {
  KeyHasher key;
  key.text("pieces").hash(parameter_hash(config, Stage::ingest)).hash(before.job.stamp);
  samples.each_file({{}, samples.info().geometry.size}, [&](const std::filesystem::path& path) {
    if (const auto state = file_state(path)) feed(key.text(path.string()), *state);
  });
  return key.finish();
}

PieceRule piece_rule(const Config& config, const IngestJob& job) {
  const VolumeInfo& info = job.pieces->before->info();
  const FilterConfig& filter = config.filters[filters_before(config.filters)];
  SurfaceParameters surface;
  surface.isovalue = config.surface.isovalue
                         ? *config.surface.isovalue
                         : Isovalue(choose_isovalue(config, job).threshold.value);
  surface.inside =
      config.surface.inside == SurfaceConfig::Inside::above ? Inside::above : Inside::below;
  to_stored(surface, info.scale, info.type);
  const bool fill = filter.type == FilterType::fill;
  PieceRule rule;
  rule.what = fill ? PieceRule::What::fill : PieceRule::What::keep;
  rule.voxels = static_cast<std::uint64_t>(fill ? filter.max_voxels : filter.min_voxels);
  rule.isovalue = surface.isovalue;
  rule.inside = surface.inside;
  if (const auto value = fill ? filter.inside : filter.outside)
    rule.value = info.scale.stored(*value);
  return rule;
}

}  // namespace

IngestJob plan_filtered(const Config& config, const std::filesystem::path& folder,
                        const InterruptFlag* interrupt) {
  std::size_t next = filters_before(config.filters);
  const bool asks = config.filters[next].is_global();
  const auto before = plan_earlier(config_before(config, next), interrupt);
  IngestJob job;
  std::shared_ptr<SampleSource> source = before->job.input;
  if (asks || before->job.copy) {
    job.earlier.push_back(before);
    source = std::make_shared<LaterVolume>(before);
  }
  if (asks) {
    ++next;
    job.pieces = PiecesJob{source, folder / "pieces", pieces_key(config, *before, *source)};
    source = pieces_source(source, job.pieces->path, job.pieces->key);
  }
  for (; next < config.filters.size(); ++next) {
    const std::size_t number = next + 1;
    source = filter_source(
        source, {config.filters[next], number, plan_mask(config, number, interrupt, job)});
  }
  job.input = source;
  job.info = source->info();
  return job;
}

bool earlier_is_current(const IngestJob& job) {
  return std::ranges::all_of(job.earlier,
                             [](const auto& one) {
                               return ingest_stage(one->config, one->job)->look({}).current();
                             }) &&
         (!job.pieces || pieces_are_found(job.pieces->path, job.pieces->key));
}

void finish_earlier(RunContext& context, const IngestJob& job) {
  // What belongs to no unit of the stage under way.
  const auto apart = [&](const Config& config) {
    RunContext one = context;
    one.config = config;
    one.selection = {};
    one.reports.clear();
    one.nans = {};
    return one;
  };
  for (const auto& earlier : job.earlier) {
    const auto work = ingest_stage(earlier->config, earlier->job);
    if (work->look({}).current()) continue;
    const WorkClaim claim(context, earlier->job.folder);
    if (work->look({}).current()) continue;  // another task's work meanwhile
    RunContext one = apart(earlier->config);
    const UnitsHere here(one);
    do_stage(one, *work);
  }
  const auto found = [&] {
    return !job.pieces || pieces_are_found(job.pieces->path, job.pieces->key);
  };
  if (found()) return;
  // A folder of its own: that of the job may be claimed already, as one that another needs before.
  const WorkClaim claim(context, job.pieces->path.string() + ".claim");
  if (found()) return;
  RunContext one = apart(context.config);
  find_pieces(one, *job.pieces->before, piece_rule(context.config, job), job.pieces->path,
              job.pieces->key);
}

const IngestJob& histogram_job(const IngestJob& job) {
  return job.pieces ? histogram_job(job.earlier.front()->job) : job;
}

}  // namespace voxweld
