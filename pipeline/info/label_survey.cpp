#include "pipeline/info/label_survey.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/ingest/label_tally.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t most_labels = std::size_t{1} << 18;  // in memory
constexpr std::size_t largest_told = 10;

class Survey {
 public:
  void add(const LabelCount& count) {
    if (labels_++ == 0) lowest_ = count.label;
    highest_ = count.label;
    samples_ += count.voxels;
    if (count.label == 0) background_ = count.voxels;
    // The largest first, of equals the lower label.
    const auto at = std::upper_bound(
        largest_.begin(), largest_.end(), count,
        [](const LabelCount& a, const LabelCount& b) { return a.voxels > b.voxels; });
    if (at == largest_.end() && largest_.size() == largest_told) return;
    largest_.insert(at, count);
    if (largest_.size() > largest_told) largest_.pop_back();
  }

  InfoDocument facts(std::uint64_t negatives) const {
    const double all = static_cast<double>(samples_ + negatives);
    const auto share = [&](std::uint64_t samples) {
      return all > 0 ? static_cast<double>(samples) / all : 0.0;
    };
    InfoDocument facts = {{"distinct", labels_}, {"negative_samples", negatives}};
    facts["range"] = labels_ == 0 ? InfoDocument(nullptr) : InfoDocument{lowest_, highest_};
    facts["background_share"] = share(background_);
    facts["largest"] = InfoDocument::array();
    for (const LabelCount& count : largest_)
      facts["largest"].push_back({{"label", count.label},
                                  {"samples", count.voxels},
                                  {"share", share(count.voxels)},
                                  {"from", facts_of(count.box().lo)},
                                  {"to", facts_of(count.box().hi)}});
    return facts;
  }

 private:
  std::uint64_t labels_ = 0, samples_ = 0, background_ = 0, lowest_ = 0, highest_ = 0;
  std::vector<LabelCount> largest_;
};

}  // namespace

InfoDocument label_facts(const SampleSource& source, const ScanHooks& hooks, ScanResult& scan) {
  const SampleType type = source.info().type;
  if (const std::string problem = no_labels_text(source.info()); !problem.empty())
    throw InputError(fmt::format(
        "--labels: labels are integers as they are stored, {} {}",
        source.info().files.empty() ? source.info().format : source.info().files[0].path, problem));
  LabelTally tally(std::filesystem::temp_directory_path(), most_labels);
  ScanHooks counting = hooks;
  counting.samples = [&](const Box3& band, std::span<const std::byte> samples) {
    tally.add(type, band, samples);
  };
  scan = scan_in_order(source, counting);
  const std::uint64_t negatives = tally.negatives();
  Survey survey;
  tally.finish([&](const LabelCount& count) { survey.add(count); });
  return survey.facts(negatives);
}

InfoDocument label_facts(const SampleSource& source, const ScanHooks& hooks) {
  ScanResult scan;
  return label_facts(source, hooks, scan);
}

InfoDocument label_facts(const LabelCounts& counts) {
  Survey survey;
  counts.each([&](const LabelCount& count) {
    survey.add(count);
    return true;
  });
  return survey.facts(counts.summary().negatives);
}

}  // namespace voxweld
