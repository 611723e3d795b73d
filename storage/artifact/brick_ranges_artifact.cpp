#include "storage/artifact/brick_ranges_artifact.h"

#include <algorithm>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

constexpr std::uint64_t ranges_section = 1;

bool is_sound(const std::vector<BrickRange>& ranges) {
  const auto sound = [](const BrickRange& r) {
    return r.flags <= 3 && ((r.flags & 2) != 0 || r.lo <= r.hi);
  };
  const auto descends = [](const BrickRange& a, const BrickRange& b) { return a.brick >= b.brick; };
  return std::ranges::all_of(ranges, sound) &&
         std::ranges::adjacent_find(ranges, descends) == ranges.end();
}

}  // namespace

void write_brick_ranges(const std::filesystem::path& path, const BrickRangesArtifact& artifact) {
  ArtifactWriter out(path, {brick_ranges_kind, brick_ranges_version, artifact.key});
  out.set_input_stamp(artifact.stamp);
  out.section(ranges_section, as_section(artifact.ranges));
  out.commit();
}

BrickRangesArtifact read_brick_ranges(const std::filesystem::path& path) {
  const ArtifactReader in(path, brick_ranges_kind, brick_ranges_version);
  BrickRangesArtifact artifact{in.key(), in.input_stamp(), {}};
  in.read_array(ranges_section, artifact.ranges);
  if (!is_sound(artifact.ranges)) in.damaged("its ranges are none, or in no order");
  return artifact;
}

}  // namespace voxweld
