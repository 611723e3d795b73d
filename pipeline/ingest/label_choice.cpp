#include "pipeline/ingest/label_choice.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/ingest/label_ingest.h"
#include "pipeline/ingest/label_rules.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

LabelMap read_map(const Config& config) {
  const LabelsConfig& labels = config.labels;
  if (labels.map.empty()) return {};
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(labels.map, error);
  const std::uint64_t need = program_bytes() + (error ? 0 : label_map_bytes_per_byte * size);
  if (need > config.run.memory)
    throw InputError(fmt::format(
        "{}: run.memory = {} is not enough for this file of {}, which takes up to {}; raise "
        "run.memory",
        labels.map.string(), exact_bytes(config.run.memory),
        readable_bytes(static_cast<double>(size)), readable_bytes(static_cast<double>(need))));
  return read_label_map(labels.map);
}

void warn_of_background(const LabelsConfig& labels, const LabelMap& map) {
  if (const std::string left_out = background_in_map(labels, map); !left_out.empty())
    spdlog::warn(
        "{}: labels.background leaves out {} although the file makes materials of them; change "
        "labels.background if they are meant",
        labels.map.string(), left_out);
}

// What they give needs no label in the volume.
bool edits_give_labels(const Config& config) {
  return std::any_of(config.edits.begin(), config.edits.end(),
                     [](const EditConfig& edit) { return edit.op == EditOp::add; });
}

// That there is something to mesh and nothing that cannot be.
void check_labels(const Config& config, const MaterialRules& chosen, const LabelCounts& counts) {
  const std::string path = config.input.path.string();
  const LabelSummary& all = counts.summary();
  if (all.labels == 0 && !edits_give_labels(config))
    throw InputError(path + ": no sample is a label: all of them are below zero");
  LabelCount first, last;
  bool any = false;
  counts.each([&](const LabelCount& count) {
    if (first.voxels == 0) first = count;
    any = chosen.of(count.label) != exterior;
    return !any;
  });
  if (all.highest == exterior) {
    counts.each([&](const LabelCount& count) {
      last = count;
      return true;
    });
    throw InputError(fmt::format(
        "{}: {} samples are {}, the first in slice {}; that number stands for what is outside, and "
        "labels end at {}: give them another",
        path, last.voxels, exterior, last.lo[2], highest_label));
  }
  if (!any && !edits_give_labels(config))
    throw InputError(fmt::format(
        "labels.select, labels.background{}: none of the {} labels of {} is left, which run from "
        "{} to {}; choose some of them",
        config.labels.map.empty() ? "" : " and labels.map", all.labels, path, first.label,
        all.highest));
}

// Those of a size that is asked for.
MaterialRules sized(const Config& config, const MaterialRules& chosen, const LabelCounts& counts) {
  const std::uint64_t memory = config.run.memory;
  MaterialRules rules =
      sized_rules(config.labels, chosen, counts, (memory - std::min(memory, program_bytes())) / 4);
  if (!rules.ranges.empty() || edits_give_labels(config)) return rules;
  std::uint64_t materials = 0, least = highest_label, most = 0;
  each_material(chosen, counts, [&](const LabelCount& count) {
    ++materials;
    least = std::min(least, count.voxels);
    most = std::max(most, count.voxels);
    return true;
  });
  throw InputError(fmt::format(
      "labels.min_voxels = {}, labels.max_voxels = {}: none of the {} materials of {} is left, "
      "which have {} to {} samples",
      config.labels.min_voxels, config.labels.max_voxels, materials, config.input.path.string(),
      least, most));
}

}  // namespace

LabelMap read_labels_map(const Config& config) {
  if (config.labels.mode == LabelMode::off) {
    if (config.labels != LabelsConfig{})
      spdlog::warn("[labels] is not looked at: labels.mode is \"off\"");
    return {};
  }
  LabelMap map = read_map(config);
  for (const std::string& warning : map.warnings) spdlog::warn("{}", warning);
  warn_of_background(config.labels, map);
  return map;
}

LabelParameters chosen_labels(const Config& config, const LabelMap& map) {
  if (config.labels.mode == LabelMode::off) return {};
  return {config.labels.mode,
          std::make_shared<const MaterialRules>(chosen_rules(config.labels, map))};
}

LabelParameters final_labels(const Config& config, const LabelMap& map, const IngestJob& job) {
  LabelParameters labels = chosen_labels(config, map);
  const auto counts = labels.rules == nullptr ? std::nullopt : read_label_counts(job);
  if (!counts) return labels;
  check_labels(config, *labels.rules, *counts);
  if (asks_for_sizes(config.labels))
    labels.rules = std::make_shared<const MaterialRules>(sized(config, *labels.rules, *counts));
  return labels;
}

}  // namespace voxweld
