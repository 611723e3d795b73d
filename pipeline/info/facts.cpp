#include "pipeline/info/facts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "stages/ingest/threshold.h"
#include "storage/artifact/container.h"
#include "storage/support/file_io.h"
#include "storage/support/hash_file.h"

namespace voxweld {
namespace {

constexpr std::string_view artifact_magic = {"VOXWELD\x1a", 8};

// JSON has no infinities: null stands for them.
InfoDocument real(double value) {
  return std::isfinite(value) ? InfoDocument(value) : InfoDocument(nullptr);
}

}  // namespace

InfoDocument facts_of(Index3 v) {
  return {v.x, v.y, v.z};
}

InfoDocument facts_of(Vec3 v) {
  return {real(v.x), real(v.y), real(v.z)};
}

InfoDocument facts_of(const OutputLattice& lattice) {
  return {{"step", lattice.step}, {"bits", lattice.bits}, {"origin", lattice.origin}};
}

InfoDocument range_facts(const ValueRange& range) {
  if (range.empty) return nullptr;
  return {real(range.lo), real(range.hi)};
}

void add_level_facts(InfoDocument& document, const LeafCounts& counts) {
  document["worst_residual"] = counts.worst_collapsed();
  document["leaves"] = counts.used_leaves();
  document["errors"] = counts.used_errors();
}

void add_volume_facts(InfoDocument& document, const VolumeInfo& info, bool verbose) {
  const VolumeGeometry& g = info.geometry;
  const auto samples = static_cast<std::uint64_t>(Box3{{}, g.size}.count());
  document["format"] = info.format;
  document["size"] = facts_of(g.size);
  document["type"] = sample_type_name(info.type);
  if (!info.scale.identity()) {
    document["slope"] = info.scale.slope;
    document["intercept"] = info.scale.intercept;
  }
  if (info.surface)
    document["surface"] = {{"isovalue", info.surface->isovalue},
                           {"inside", info.surface->inside_below ? "below" : "above"}};
  document["samples"] = samples;
  document["sample_bytes"] = samples * sample_bytes(info.type);
  document["spacing"] = facts_of(g.spacing);
  document["unit"] = g.unit;
  document["origin"] = facts_of(g.origin);
  document["direction"] = InfoDocument::array();
  for (const Vec3& axis : g.direction) document["direction"].push_back(facts_of(axis));
  document["space"] = g.space;
  document["access"] = access_name(info.access);
  document["largest_decode_bytes"] = info.largest_decode;
  std::uint64_t file_bytes = 0;
  for (const InputFile& file : info.files) file_bytes += file.state.size;
  document["files"] = info.files.size();
  document["file_bytes"] = file_bytes;
  if (!info.choices.empty()) document["choices"] = InfoDocument::array();
  for (const InputChoice& choice : info.choices)
    document["choices"].push_back({{"selector", choice.selector},
                                   {"value", choice.value},
                                   {"text", choice.text},
                                   {"chosen", choice.chosen}});
  document["warnings"] = info.warnings;
  if (!verbose) return;
  document["file_list"] = InfoDocument::array();
  for (const InputFile& file : info.files)
    document["file_list"].push_back({{"path", file.path}, {"bytes", file.state.size}});
}

InfoDocument value_facts(const Histogram& histogram, const std::optional<ValueRange>& range,
                         const ValueScale& scale) {
  std::uint64_t samples = histogram.nans;
  for (const HistogramBin& bin : histogram.bins) samples += bin.count;
  InfoDocument facts = {{"samples", samples}, {"nan_samples", histogram.nans}};
  if (range) facts["range"] = range_facts(real_range(*range, scale));
  facts["quantiles"] = InfoDocument::object();
  for (const int percent : {1, 5, 25, 50, 75, 95, 99})
    if (const auto value = quantile(histogram, percent / 100.0, scale))
      facts["quantiles"][std::to_string(percent) + "%"] = *value;
  facts["bins"] = histogram.bins.size();
  facts["suggested_isovalue"] = nullptr;
  if (const auto suggestion = suggest_isovalue(histogram, scale)) {
    facts["suggested_isovalue"] = {{"value", suggestion->threshold.value},
                                   {"separability", suggestion->threshold.separability}};
    if (suggestion->padding) facts["suggested_isovalue"]["padding"] = *suggestion->padding;
  }
  return facts;
}

InfoDocument new_document(const std::string& kind, const std::filesystem::path& path) {
  return {{"kind", kind}, {"path", path.string()}};
}

InfoDocument file_document(const std::string& kind, const std::filesystem::path& path) {
  InfoDocument document = new_document(kind, path);
  document["bytes"] = std::filesystem::file_size(path);
  return document;
}

InfoDocument keyed_document(const std::string& kind, const std::filesystem::path& path,
                            Hash128 key) {
  InfoDocument document = file_document(kind, path);
  document["key"] = to_hex(key);
  return document;
}

std::optional<ArtifactHead> artifact_head(const std::filesystem::path& path) {
  constexpr std::size_t head_bytes = 16;
  const ReadFile file(path);
  if (file.size() < head_bytes) return std::nullopt;
  std::array<char, head_bytes> head;
  file.read(0, std::as_writable_bytes(std::span(head)));
  if (std::string_view(head.data(), artifact_magic.size()) != artifact_magic) return std::nullopt;
  ArtifactHead found;
  std::copy_n(head.begin() + 8, 4, found.kind.begin());
  std::memcpy(&found.version, head.data() + 12, sizeof found.version);
  return found;
}

std::uint64_t check_artifact(const std::filesystem::path& path, const ArtifactHead& head) {
  const ArtifactReader reader(path, head.kind, head.version);
  std::vector<std::byte> section;
  for (const SectionRecord& record : reader.sections()) reader.read(record.name, section);
  return std::filesystem::file_size(path);
}

Hash128 hash_file(const std::filesystem::path& path, const InterruptFlag* interrupt) {
  return hash_file(ReadFile(path), [&] {
    if (interrupt != nullptr) interrupt->check();
  });
}

}  // namespace voxweld
