#include "pipeline/neuroglancer/segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/config/config.h"
#include "stages/encode/fragment_cut.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// per_area: triangles that a square of one lattice step is expected to have.
std::int32_t chunk_for(double per_area, std::uint64_t triangles, std::uint64_t most) {
  if (triangles <= most) return fragment_chunks.front();
  for (const std::int32_t chunk : fragment_chunks)
    if (per_area * chunk * chunk <= static_cast<double>(most)) return chunk;
  return fragment_chunks.back();
}

// How dense triangles lie where most of them are: a tile's cube has so many by the area of a side.
double density_of_tiles(const std::filesystem::path& output, const Manifest& manifest) {
  const Vec3 spacing = manifest.frame.spacing;
  const double cell =
      std::cbrt(spacing.x * spacing.y * spacing.z) / manifest.lattice.step;  // in lattice steps
  double sum = 0, triangles = 0;
  TileListReader tiles(output / tiles_name);
  while (const auto tile = tiles.next()) {
    const double count = static_cast<double>(tile->triangles);
    const double side = static_cast<double>(tile->tile.side()) * cell;
    sum += count * (count / (side * side));
    triangles += count;
  }
  return triangles > 0 ? sum / triangles : 0;
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
  segment.chunk = chunk_for(density_of_label(label, manifest.lattice), label.triangles, most);
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
    const std::uint64_t triangles = manifest.counts.output_triangles;
    const double density = density_of_tiles(output, manifest);
    if (triangles > 0)
      list.segments.push_back({sole_id(manifest), "surface",
                               chunk_for(density, triangles, fragment_triangles), triangles,
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
  return list;
}

}  // namespace voxweld
