#include "pipeline/phantom/kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/phantom/junctions_field.h"
#include "pipeline/phantom/lattice_fields.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::array kinds = {
    PhantomKindInfo{PhantomKind::sphere, "sphere", "one ball"},
    PhantomKindInfo{PhantomKind::torus, "torus", "one tilted ring"},
    PhantomKindInfo{PhantomKind::gyroid, "gyroid",
                    "a ball filled with a gyroid: smooth, curved everywhere"},
    PhantomKindInfo{PhantomKind::part, "part",
                    "a machined part, turned: planes, bores, sharp edges, thin fins"},
    PhantomKindInfo{PhantomKind::temple, "temple",
                    "steps, columns and a roof, in line with the axes"},
    PhantomKindInfo{PhantomKind::labels, "labels",
                    "a ball cut into 216 Voronoi cells: integer labels, 0 around them"},
    PhantomKindInfo{PhantomKind::junctions, "junctions",
                    "labels with exact surfaces: 3 that meet in a line, 4 in a point"},
    PhantomKindInfo{PhantomKind::porous, "porous",
                    "thresholded band-limited noise: very much surface, no flat place"},
    PhantomKindInfo{PhantomKind::noise, "noise",
                    "independent random samples: every ambiguous case"},
};

}  // namespace

std::span<const PhantomKindInfo> phantom_kinds() {
  return kinds;
}

std::string_view phantom_kind_name(PhantomKind kind) {
  return kinds[static_cast<std::size_t>(kind)].name;
}

PhantomKind parse_phantom_kind(std::string_view name) {
  std::vector<std::string_view> known;
  for (const PhantomKindInfo& info : kinds) {
    if (info.name == name) return info.kind;
    known.push_back(info.name);
  }
  throw InputError(
      fmt::format("unknown phantom \"{}\": expected one of {}", name, fmt::join(known, ", ")));
}

bool holds_labels(PhantomKind kind) {
  return phantom_labels(kind) > 0;
}

std::uint64_t phantom_labels(PhantomKind kind) {
  if (kind == PhantomKind::junctions) return JunctionsField::labels;
  return kind == PhantomKind::labels ? LabelsField::labels : 0;
}

double Quantizer::limit() const {
  if (highest == 0 || offset == 0) return std::numeric_limits<double>::infinity();
  return std::max(offset, highest + 1 - offset) / gain;
}

Quantizer phantom_quantizer(PhantomKind kind, SampleType type) {
  if (holds_labels(kind)) {
    if (type != SampleType::f32 && type != SampleType::f64) return {0, 1, 65535};
    throw InputError(
        fmt::format("phantom {}: sample type {} is not offered: labels are integers, "
                    "use uint8 .. uint64 or int8 .. int64",
                    phantom_kind_name(kind), sample_type_name(type)));
  }
  // porous reaches further from its surface than 2048 steps a voxel leave room for.
  const double scale = kind == PhantomKind::porous ? 800.0 / 2048.0 : 1.0;
  if (type == SampleType::u8) return {128, 16 * scale, 255};
  if (type == SampleType::u16) return {32768, 2048 * scale, 65535};
  if (type == SampleType::f32) return {0, 1, 0};
  throw InputError(
      fmt::format("phantom {}: sample type {} is not offered: use uint8, uint16 or float32",
                  phantom_kind_name(kind), sample_type_name(type)));
}

std::optional<double> phantom_isovalue(PhantomKind kind, SampleType type) {
  const Quantizer quantizer = phantom_quantizer(kind, type);
  if (holds_labels(kind)) return std::nullopt;
  return type == SampleType::f32 ? 0.0 : quantizer.offset - 0.5;
}

}  // namespace voxweld
