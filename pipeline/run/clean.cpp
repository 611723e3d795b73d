#include "pipeline/run/clean.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/run/last_config.h"
#include "pipeline/run/output_claim.h"
#include "pipeline/run/stages.h"
#include "pipeline/stage/file_layout.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Where pipeline/slurm keeps scripts and logs.
constexpr const char* slurm_folder_name = "slurm";

// The same for the same place, whether it is there or not.
fs::path place_of(const fs::path& directory) {
  fs::path path = fs::weakly_canonical(directory);
  return path.has_filename() ? path : path.parent_path();
}

// Those of an ingest and of what it is made from.
void add_folders(const IngestJob& job, std::set<fs::path>& folders) {
  folders.insert(job.folder.filename());
  for (const auto& earlier : job.earlier) add_folders(earlier->job, folders);
}

// What a run of one config would use of its work directory.
struct Used {
  std::set<fs::path> folders;
  bool later_stages_known = false;
};

Used used_by(RunContext& context) {
  Used used;
  Stages stages(context);
  StageWork& ingest = stages.open(Stage::ingest);
  add_folders(stages.jobs().ingest(), used.folders);
  StageLook look = ingest.look({});
  ingest.prove(context, look);
  if (!look.current()) return used;
  stages.open(Stage::build);
  if (!stages.folders_are_known()) return used;
  for (const fs::path& folder : stages.jobs().later_folders())
    used.folders.insert(folder.filename());
  used.later_stages_known = true;
  return used;
}

bool is_link(const fs::path& path) {
  std::error_code error;
  return fs::is_symlink(fs::symlink_status(path, error));
}

// Of all files below, not through links.
std::uint64_t bytes_below(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return fs::file_size(path, error);
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file(error) && !entry.is_symlink(error)) bytes += entry.file_size(error);
  return bytes;
}

void remove_wholly(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) throw_errno("remove", path.string(), error.value());
}

// One work directory and the configs that have it.
struct Place {
  fs::path directory;
  std::vector<RunContext*> contexts;
};

std::vector<Place> places_of(std::span<const std::unique_ptr<RunContext>> configs) {
  std::vector<Place> places;
  for (const auto& context : configs) {
    const fs::path directory = place_of(context->config.work.directory);
    auto place = std::ranges::find(places, directory, &Place::directory);
    if (place == places.end()) place = places.insert(places.end(), {directory, {}});
    place->contexts.push_back(context.get());
  }
  return places;
}

// Everything of ours in the directory: folders of stages, what extractions that were killed have left,
// and with `all` the rest.
std::vector<fs::path> ours_in(const fs::path& directory, bool all) {
  std::vector<fs::path> paths;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(directory, missing)) {
    if (is_link(entry.path())) continue;
    const bool folder = entry.is_directory();
    const std::string name = entry.path().filename().string();
    const bool rest = folder ? name == slurm_folder_name : name == last_config_name;
    const bool ours = stage_of_folder(entry.path()) || is_extract_folder(entry.path());
    if ((folder && ours) || (all && rest)) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

// A run of another config that shares the directory may be at work; those named here have ended.
void refuse_at_work(const Place& place) {
  for (const fs::path& path : ours_in(place.directory, false))
    if (const auto holder = lock_holder(path))
      throw InputError(fmt::format(
          "work.directory = \"{}\": process {} on {} is at work in {} for {}; wait until that run "
          "has ended",
          place.directory.string(), holder->process, holder->host, path.filename().string(),
          holder->owner));
}

CleanReport clean_place(const Place& place, const CleanOptions& options) {
  CleanReport report{place.directory, {}, 0, {}};
  std::set<fs::path> used;
  for (RunContext* context : place.contexts) {
    if (options.all) continue;
    const Used one = used_by(*context);
    used.insert(one.folders.begin(), one.folders.end());
    if (!one.later_stages_known) report.unknown.push_back(context->config_file);
  }
  for (const fs::path& path : ours_in(place.directory, options.all)) {
    const bool later = stage_of_folder(path).value_or(Stage::ingest) != Stage::ingest;
    if (used.contains(path.filename()) || (later && !report.unknown.empty())) {
      ++report.kept;
      continue;
    }
    for (const RunContext* context : place.contexts)
      if (context->interrupt != nullptr) context->interrupt->check();
    report.removed.push_back({path, bytes_below(path)});
    if (!options.dry_run) remove_wholly(path);
  }
  std::error_code not_empty;
  if (options.all && !options.dry_run) fs::remove(place.directory, not_empty);
  return report;
}

// One for each output directory: who holds a lock would wait for itself.
std::vector<std::unique_ptr<OutputClaim>> claims_of(
    std::span<const std::unique_ptr<RunContext>> configs) {
  std::vector<std::unique_ptr<OutputClaim>> claims;
  std::set<fs::path> claimed;
  for (const auto& context : configs) {
    context->force = true;  // whose meshes lie there does not matter: they stay
    if (claimed.insert(place_of(context->config.output.directory)).second)
      claims.push_back(std::make_unique<OutputClaim>(*context));
  }
  return claims;
}

}  // namespace

std::uint64_t CleanReport::bytes() const {
  std::uint64_t sum = 0;
  for (const CleanedPath& one : removed) sum += one.bytes;
  return sum;
}

std::vector<CleanReport> clean(std::span<const std::unique_ptr<RunContext>> configs,
                               const CleanOptions& options) {
  std::vector<std::unique_ptr<OutputClaim>> claims;
  if (!options.dry_run) claims = claims_of(configs);
  const std::vector<Place> places = places_of(configs);
  if (!options.dry_run) std::ranges::for_each(places, refuse_at_work);
  std::vector<CleanReport> reports;
  reports.reserve(places.size());
  for (const Place& place : places) reports.push_back(clean_place(place, options));
  return reports;
}

}  // namespace voxweld
