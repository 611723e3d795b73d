#include "storage/artifact/label_counts.h"

namespace voxweld {
namespace {

constexpr std::uint64_t labels_summary_section = 1, first_counts_section = 2;

}  // namespace

LabelCountsWriter::LabelCountsWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {label_counts_kind, label_counts_version, key}),
      counts_(file_, first_counts_section) {}

void LabelCountsWriter::add(const LabelCount& count) {
  counts_.push(count);
  ++summary_.labels;
  summary_.samples += count.voxels;
  summary_.highest = count.label;
}

void LabelCountsWriter::commit(std::uint64_t negatives) {
  counts_.finish();
  summary_.negatives = negatives;
  file_.section(labels_summary_section, as_record(summary_));
  file_.commit();
}

LabelCounts::LabelCounts(const std::filesystem::path& path)
    : OpenArtifact(path, label_counts_kind, label_counts_version),
      summary_(
          file_.read_record<LabelSummary>(labels_summary_section, "its summary has an odd size")) {}

void LabelCounts::each(const std::function<bool(const LabelCount&)>& f) const {
  std::vector<LabelCount> counts;
  LabelSummary seen;
  for (std::uint64_t section = first_counts_section; file_.find(section) != nullptr; ++section) {
    file_.read_array(section, counts);
    for (const LabelCount& count : counts) {
      if ((seen.labels > 0 && count.label <= seen.highest) || count.voxels == 0)
        file_.damaged("its labels are not in order");
      ++seen.labels;
      seen.samples += count.voxels;
      seen.highest = count.label;
      if (!f(count)) return;
    }
  }
  seen.negatives = summary_.negatives;
  if (seen != summary_) file_.damaged("its sections contradict each other");
}

}  // namespace voxweld
