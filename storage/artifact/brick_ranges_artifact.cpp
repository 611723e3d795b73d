#include "storage/artifact/brick_ranges_artifact.h"

#include <algorithm>

#include "storage/artifact/container.h"
#include "storage/support/error.h"

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

void write_brick_ranges(const std::filesystem::path& path, Hash128 key, Hash128 stamp,
                        std::span<const BrickRange> ranges) {
  ArtifactWriter out(path, {brick_ranges_kind, brick_ranges_version, key});
  out.set_input_stamp(stamp);
  out.section(ranges_section, std::as_bytes(ranges));
  out.commit();
}

std::optional<std::vector<BrickRange>> read_brick_ranges(const std::filesystem::path& path,
                                                         Hash128 key, Hash128 stamp) {
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return std::nullopt;
  try {
    const ArtifactReader in(path, brick_ranges_kind, brick_ranges_version);
    if (in.key() != key || in.input_stamp() != stamp) return std::nullopt;
    auto ranges = in.read_array<BrickRange>(ranges_section);
    if (!is_sound(ranges)) return std::nullopt;
    return ranges;
  } catch (const Error&) {
    return std::nullopt;  // the bricks are read, and it is written anew
  }
}

}  // namespace voxweld
