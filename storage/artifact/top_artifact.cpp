#include "storage/artifact/top_artifact.h"

#include <algorithm>

#include "storage/artifact/node_record_bytes.h"

namespace voxweld {
namespace {

constexpr std::uint64_t tiles_section = 2;
constexpr std::uint64_t clusters_section = 7;
constexpr std::uint64_t first_leaf_section = 0x1000000;
constexpr std::size_t leaves_per_section = 4096;

static_assert(std::has_unique_object_representations_v<PlannedTile>);

}  // namespace

TopArtifactWriter::TopArtifactWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {top_kind, top_version, key}) {}

void TopArtifactWriter::leaf(const TopLeaf& leaf) {
  pending_.push_back(leaf);
  if (pending_.size() == leaves_per_section) flush_leaves();
}

void TopArtifactWriter::flush_leaves() {
  if (pending_.empty()) return;
  file_.section(first_leaf_section + first_codes_.size(), as_section(pending_));
  first_codes_.push_back(pending_.front().code);
  pending_.clear();
}

void TopArtifactWriter::tile(const PlannedTile& tile) {
  tiles_.push_back(tile);
}

void write_clusters(ArtifactWriter& file, std::uint64_t section, const ReducedNode& top) {
  ReducedNode links{{}, top.leaves, top.nodes, top.links, {}};
  for (ClusterLink& link : links.links) link.root = no_cluster;
  std::vector<std::byte> bytes;
  put_links(links, bytes);
  file.section(section, bytes);
}

ReducedNode read_clusters(const ArtifactReader& file, std::uint64_t section) {
  ReducedNode top;
  if (file.find(section) == nullptr) return top;
  std::vector<std::byte> bytes;
  file.read(section, bytes);
  if (!RecordBytes(bytes).take_links(top)) file.damaged("the links of its clusters are wrong");
  return top;
}

void TopArtifactWriter::clusters(const ReducedNode& top) {
  write_clusters(file_, clusters_section, top);
}

Hash128 TopArtifactWriter::finish(const MergeCounts& counts, std::span<const Hash128> shards) {
  flush_leaves();
  file_.section(top_counts_section, as_record(counts));
  file_.section(tiles_section, as_section(tiles_));
  file_.section(top_codes_section, as_section(first_codes_));
  file_.section(top_shards_section, std::as_bytes(shards));
  return file_.commit();
}

TopArtifact::TopArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, top_kind, top_version) {
  if (!of_labels()) file_.read_array(top_codes_section, first_codes_);
}

MergeCounts TopArtifact::counts() const {
  return file_.read_record<MergeCounts>(top_counts_section, "has no counts");
}

std::vector<PlannedTile> TopArtifact::tiles() const {
  return file_.read_array<PlannedTile>(tiles_section);
}

std::vector<Hash128> TopArtifact::shards() const {
  return file_.read_array<Hash128>(top_shards_section);
}

ReducedNode TopArtifact::clusters() const {
  return read_clusters(file_, clusters_section);
}

std::uint64_t TopArtifact::cluster_bytes() const {
  const SectionRecord* section = file_.find(clusters_section);
  return section == nullptr ? 0 : section->size;
}

std::vector<TopLeaf> TopArtifact::leaves(std::uint64_t begin, std::uint64_t end) const {
  std::vector<TopLeaf> found, section;
  // The section before the first that starts inside may still reach into the range.
  auto first = std::upper_bound(first_codes_.begin(), first_codes_.end(), begin);
  if (first != first_codes_.begin()) --first;
  for (; first != first_codes_.end() && *first < end; ++first) {
    file_.read_array(first_leaf_section + static_cast<std::uint64_t>(first - first_codes_.begin()),
                     section);
    for (const TopLeaf& leaf : section) {
      const std::uint64_t leaf_end = leaf.code + (std::uint64_t{1} << (3 * leaf.level));
      if (leaf.code < end && leaf_end > begin) found.push_back(leaf);
    }
  }
  return found;
}

}  // namespace voxweld
