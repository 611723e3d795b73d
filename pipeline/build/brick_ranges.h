// What an earlier build found of the samples of one shard's bricks, where the volume itself does not
// tell ranges, and what this one finds.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/stage/artifacts.h"
#include "storage/artifact/brick_ranges_artifact.h"

namespace voxweld {

class BrickRanges {
 public:
  explicit BrickRanges(const BuildJob& job) : job_(job) {}

  // Takes what is there of the shard's samples, unless all are to be read. stamp: theirs.
  void open(Index3 shard, Hash128 stamp, bool read_all);
  // Of the samples the brick's cells touch, in the volume. Nothing of those with NaNs: these are read,
  // since whoever reads counts them.
  std::optional<ValueRange> of(Index3 brick) const;

  bool are_known() const { return known_.has_value(); }

  // Of a brick that was read. Then all of them to disk, once the shard is done; does nothing where
  // some were not read, or are there.
  void add(const BrickRange& found) { found_.push_back(found); }
  void close();

 private:
  const BuildJob& job_;
  Index3 shard_;
  Hash128 stamp_;
  std::optional<std::vector<BrickRange>> known_;
  std::vector<BrickRange> found_;
};

}  // namespace voxweld
