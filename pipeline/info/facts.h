// Pieces of info documents that several kinds share.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "pipeline/info/info.h"
#include "storage/support/hash.h"
#include "storage/types/brick_octree.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

InfoDocument facts_of(Index3 v);
InfoDocument facts_of(Vec3 v);
InfoDocument facts_of(const OutputLattice& lattice);
InfoDocument range_facts(const ValueRange& range);  // null when empty
// Leaves and errors by level, without the empty levels at the end.
void add_level_facts(InfoDocument& document, const LeafCounts& counts);
// Appends the keys a volume's geometry and samples give.
void add_volume_facts(InfoDocument& document, const VolumeInfo& info, bool verbose);
// Of stored samples, in the real values that the scale makes of them.
InfoDocument value_facts(const Histogram& histogram, const std::optional<ValueRange>& range,
                         const ValueScale& scale = {});

InfoDocument new_document(const std::string& kind, const std::filesystem::path& path);
// Of one file: with its size.
InfoDocument file_document(const std::string& kind, const std::filesystem::path& path);
// Of a file of ours: with its key too.
InfoDocument keyed_document(const std::string& kind, const std::filesystem::path& path,
                            Hash128 key);

// What was read to check it, and what was found.
class CheckResult {
 public:
  CheckResult& read(std::uint64_t bytes) {
    ++files_;
    bytes_ += bytes;
    return *this;
  }
  void damaged(const std::string& path, const std::string& what) {
    damaged_.push_back({{"path", path}, {"what", what}});
  }
  InfoDocument facts() const {
    return {{"files", files_}, {"bytes", bytes_}, {"damaged", damaged_}};
  }

 private:
  std::uint64_t files_ = 0, bytes_ = 0;
  InfoDocument damaged_ = InfoDocument::array();
};

// The kind and version in the header of an artifact of ours; nothing when the file is none.
struct ArtifactHead {
  std::array<char, 4> kind{};
  std::uint32_t version = 0;
  std::string name() const { return {kind.begin(), kind.end()}; }
};
std::optional<ArtifactHead> artifact_head(const std::filesystem::path& path);
// Reads every section of the artifact; DamagedArtifact where a checksum is wrong. Returns the bytes
// read.
std::uint64_t check_artifact(const std::filesystem::path& path, const ArtifactHead& head);

Hash128 hash_file(const std::filesystem::path& path, const InterruptFlag* interrupt);

}  // namespace voxweld
