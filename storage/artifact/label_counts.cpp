#include "storage/artifact/label_counts.h"

namespace voxweld {
namespace {

constexpr std::uint64_t labels_summary_section = 1, first_counts_section = 2;
constexpr std::size_t counts_a_section = 16384;

}  // namespace

LabelCountsWriter::LabelCountsWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {label_counts_kind, label_counts_version, key}),
      next_section_(first_counts_section) {}

void LabelCountsWriter::add(const LabelCount& count) {
  counts_.push_back(count);
  ++summary_.labels;
  summary_.samples += count.voxels;
  summary_.highest = count.label;
  if (counts_.size() == counts_a_section) flush();
}

void LabelCountsWriter::flush() {
  if (counts_.empty()) return;
  file_.section(next_section_++, std::as_bytes(std::span(counts_)));
  counts_.clear();
}

void LabelCountsWriter::commit(std::uint64_t negatives) {
  flush();
  summary_.negatives = negatives;
  file_.section(labels_summary_section, std::as_bytes(std::span(&summary_, 1)));
  file_.commit();
}

LabelCounts::LabelCounts(const std::filesystem::path& path)
    : file_(path, label_counts_kind, label_counts_version) {
  std::vector<LabelSummary> summary;
  file_.read_array(labels_summary_section, summary);
  if (summary.size() != 1) file_.damaged("its summary has an odd size");
  summary_ = summary[0];
}

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
