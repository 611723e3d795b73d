#include "pipeline/neuroglancer/segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/config/config.h"
#include "stages/encode/fragment_cut.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The side of fragments for which they have about as many triangles as `wanted`: the largest with no more, or the
// next larger one, where it has up to twice as many and is nearer by ratio. Some sides are five times the next,
// for which a fragment has a hundredth of the triangles in a volume full of surface.
template <class Triangles>
std::int32_t chunk_for(std::uint64_t wanted, Triangles triangles_at) {
  const auto number = static_cast<double>(wanted);
  std::optional<std::pair<std::int32_t, double>> larger;
  for (const std::int32_t chunk : fragment_chunks) {
    const double found = triangles_at(chunk);
    if (found <= number) {
      const bool near = larger && larger->second <= 2 * number &&
                        larger->second / number < number / std::max(found, 1.0);
      return near ? larger->first : chunk;
    }
    larger = {chunk, found};
  }
  return fragment_chunks.back();
}

// The most triangles that a fragment of this side is expected to have: a smaller tile has all of its own in
// the fragment that its cube begins in, and a larger one as many in each as its area tells.
double most_of_tiles(const std::vector<TileRecord>& tiles, const Manifest& manifest, double chunk) {
  const Vec3 spacing = manifest.frame.spacing;
  std::map<std::array<std::int64_t, 3>, double> sums;
  double most = 0;
  for (const TileRecord& tile : tiles) {
    const auto side = static_cast<double>(tile.tile.side());  // in cells
    std::array<std::int64_t, 3> fragment{};
    double area = 1;
    for (int a = 0; a < 3; ++a) {
      const double cell = spacing[a] / manifest.lattice.step;  // in lattice steps
      fragment[static_cast<std::size_t>(a)] =
          static_cast<std::int64_t>(static_cast<double>(tile.tile.at[a]) * side * cell / chunk);
      area *= std::max(1.0, side * cell / chunk);
    }
    double& sum = sums[fragment];
    sum += static_cast<double>(tile.triangles) / std::pow(area, 2.0 / 3);
    most = std::max(most, sum);
  }
  return most;
}

std::int32_t chunk_of_tiles(const std::filesystem::path& output, const Manifest& manifest,
                            std::uint64_t most) {
  std::vector<TileRecord> tiles;
  TileListReader reader(output / tiles_name);
  while (auto tile = reader.next()) {
    tile->files.clear();
    tiles.push_back(std::move(*tile));
  }
  return chunk_for(most, [&](std::int32_t chunk) {
    return most_of_tiles(tiles, manifest, static_cast<double>(chunk));
  });
}

// Without files of tiles there is nothing to read.
void require_tiles(const std::filesystem::path& output) {
  TileListReader tiles(output / tiles_name);
  while (const auto tile = tiles.next())
    if (!tile->files.empty()) return;
  throw InputError(output.string() +
                   ": has no tiles, of which fragments are made; set output.tiles to true, and run "
                   "again");
}

// A surface that bends has more area in a cube than a side of it.
constexpr double bends = 1.5;

double density_of_label(const LabelRecord& label, const OutputLattice& lattice) {
  const double area = label.area / (lattice.step * lattice.step);
  return area > 0 ? bends * static_cast<double>(label.triangles) / area : 0;
}

// Of a run with surface.label that label, else 1.
std::uint64_t sole_id(const Manifest& manifest) {
  if (manifest.config == nullptr || !manifest.config->is_object() ||
      !manifest.config->contains("toml"))
    return 1;
  const Config config = parse_config(manifest.config->at("toml").get<std::string>(),
                                     manifest.config->value("path", "config.toml"));
  const std::uint64_t label = config.surface.label.value_or(1);
  return label == 0 ? 1 : label;
}

Segment of_label(const LabelRecord& label, const Manifest& manifest, std::uint64_t most) {
  Segment segment{label.label, label.name, 0, label.triangles, label.volume, label.area};
  const double density = density_of_label(label, manifest.lattice);
  segment.chunk = chunk_for(most, [&](std::int32_t chunk) {
    return std::min(static_cast<double>(label.triangles), density * chunk * chunk);
  });
  return segment;
}

}  // namespace

std::optional<std::size_t> SegmentList::find(Material label) const {
  if (!labels) return 0;
  const auto at = std::ranges::lower_bound(segments, label, {}, &Segment::id);
  if (at == segments.end() || at->id != label) return std::nullopt;
  return static_cast<std::size_t>(at - segments.begin());
}

SegmentList read_segments(const std::filesystem::path& output, const Manifest& manifest,
                          std::uint64_t fragment_triangles) {
  SegmentList list;
  list.labels = manifest.labels != LabelMode::off;
  if (!list.labels) {
    const std::uint64_t triangles = manifest.counts.triangles;
    if (triangles > 0)
      list.segments.push_back({sole_id(manifest), "surface",
                               chunk_of_tiles(output, manifest, fragment_triangles), triangles,
                               std::nullopt, std::nullopt});
  } else {
    LabelListReader labels(output / labels_name);
    while (const auto label = labels.next()) {
      if (label->triangles == 0) continue;
      list.left_out_zero |= label->label == 0;
      if (label->label != 0)
        list.segments.push_back(of_label(*label, manifest, fragment_triangles));
    }
  }
  if (list.segments.empty())
    throw InputError(fmt::format(
        "{}: has no {}triangles to export; see its manifest.json for what the run made",
        output.string(),
        list.left_out_zero ? "label but 0, which Neuroglancer does not take, with " : ""));
  require_tiles(output);
  return list;
}

}  // namespace voxweld
