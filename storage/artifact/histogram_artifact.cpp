#include "storage/artifact/histogram_artifact.h"

#include <vector>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

enum HistogramSection : std::uint64_t {
  bins_section = 1,
  counts_section,
  nans_section,
  type_section
};

bool sound(const std::vector<std::uint64_t>& bins, const std::vector<std::uint64_t>& counts,
           SampleType type) {
  if (bins.size() != counts.size()) return false;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const bool ascending = i == 0 || bins[i - 1] < bins[i];
    if (!ascending || bins[i] >= histogram_bins(type) || counts[i] == 0) return false;
  }
  return true;
}

}  // namespace

void write_histogram_artifact(const std::filesystem::path& path,
                              const HistogramArtifact& artifact) {
  std::vector<std::uint64_t> bins, counts;
  for (const HistogramBin& bin : artifact.histogram.bins) {
    bins.push_back(bin.bin);
    counts.push_back(bin.count);
  }
  const auto type = static_cast<std::uint64_t>(artifact.histogram.type);
  ArtifactWriter out(path, {histogram_kind, histogram_version, artifact.key});
  out.section(bins_section, as_section(bins));
  out.section(counts_section, as_section(counts));
  out.section(nans_section, as_record(artifact.histogram.nans));
  out.section(type_section, as_record(type));
  out.commit();
}

HistogramArtifact read_histogram_artifact(const std::filesystem::path& path) {
  const ArtifactReader in(path, histogram_kind, histogram_version);
  const auto bins = in.read_array<std::uint64_t>(bins_section);
  const auto counts = in.read_array<std::uint64_t>(counts_section);
  const auto nans = in.read_array<std::uint64_t>(nans_section);
  const auto type = in.read_array<std::uint64_t>(type_section);
  if (nans.size() != 1 || type.size() != 1 ||
      type[0] > static_cast<std::uint64_t>(SampleType::f64) ||
      !sound(bins, counts, static_cast<SampleType>(type[0])))
    in.damaged("its sections contradict each other");
  HistogramArtifact artifact{in.key(), {}};
  artifact.histogram.type = static_cast<SampleType>(type[0]);
  artifact.histogram.nans = nans[0];
  for (std::size_t i = 0; i < bins.size(); ++i)
    artifact.histogram.bins.push_back({static_cast<std::uint32_t>(bins[i]), counts[i]});
  return artifact;
}

}  // namespace voxweld
