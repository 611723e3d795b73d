#include "storage/artifact/top_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t top_counts_section = 1, top_shards_section = 4;

}  // namespace

Hash128 TopArtifactWriter::finish(const MergeCounts& counts, std::span<const Hash128> shards) {
  finish_pages();
  file().section(top_counts_section, as_record(counts));
  file().section(top_shards_section, std::as_bytes(shards));
  return finish_tables();
}

TopArtifact::TopArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, top_kind, top_version) {}

MergeCounts TopArtifact::counts() const {
  return file_.read_record<MergeCounts>(top_counts_section, "has no counts");
}

std::vector<Hash128> TopArtifact::shards() const {
  return file_.read_array<Hash128>(top_shards_section);
}

}  // namespace voxweld
