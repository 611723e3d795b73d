// The samples of each label of a volume or of a part of it. Kind "lcnt", a container with these
// sections:
//   1      labels u64, samples of labels u64, samples below zero u64, the highest label u64
//   2 ..   the labels, ascending, 16384 a section and what is left in the last: label u64, samples
//          u64, the box that holds them: x y z u32 of its lower corner, x y z u32 behind its upper
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <vector>

#include "storage/artifact/paged_table.h"
#include "storage/types/label_count.h"

namespace voxweld {

inline constexpr std::array<char, 4> label_counts_kind = {'l', 'c', 'n', 't'};
inline constexpr std::uint32_t label_counts_version = 1;

struct LabelSummary {
  std::uint64_t labels = 0;     // different ones
  std::uint64_t samples = 0;    // of a label
  std::uint64_t negatives = 0;  // samples that are of none, being below zero
  std::uint64_t highest = 0;    // label, where there is one
  friend bool operator==(const LabelSummary&, const LabelSummary&) = default;
};

// Memory: one section, 640 KiB.
class LabelCountsWriter {
 public:
  LabelCountsWriter(const std::filesystem::path& path, Hash128 key);
  void add(const LabelCount& count);  // ascending
  void commit(std::uint64_t negatives);

 private:
  ArtifactWriter file_;
  PagedTableWriter<LabelCount, 16384> counts_;
  LabelSummary summary_;
};

class LabelCounts : public OpenArtifact {
 public:
  // DamagedArtifact when it fails its checks, StorageError when it cannot be read.
  explicit LabelCounts(const std::filesystem::path& path);

  const LabelSummary& summary() const { return summary_; }

  // Calls f with each label, ascending, until it returns false. Memory: one section.
  void each(const std::function<bool(const LabelCount&)>& f) const;

 private:
  LabelSummary summary_;
};

}  // namespace voxweld
