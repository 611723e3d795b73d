// What the contouring depends on, besides the volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "storage/types/box.h"
#include "storage/types/isovalue.h"
#include "storage/types/material.h"
#include "storage/types/solid.h"

namespace voxweld {

enum class Inside : std::uint8_t { above, below };  // samples equal to the isovalue are inside
enum class Border : std::uint8_t { closed, open };
enum class Gradient : std::uint8_t { eno, central, subcell };
enum class Metric : std::uint8_t { rms, sum };
// manifold: every sheet by itself; with labels.mode = "shared" as safe.
enum class Topology : std::uint8_t { safe, free, manifold };
enum class QefForm : std::uint8_t { qr, normal };

struct SurfaceParameters {
  // Of a label volume: inside are the samples of this value, and isovalue, inside and gradient are
  // not looked at.
  std::optional<std::uint64_t> label;
  Isovalue isovalue;  // of the samples as stored (stored_surface.h)
  Inside inside = Inside::above;
  Border border = Border::closed;
  Gradient gradient = Gradient::eno;
  // Of subcell: the standard deviation of the noise of the samples as stored. Kinks that it could
  // make are taken for none.
  double noise = 0;
};

// Of topology = "manifold": a node with more clusters or curves (stages/contouring/node_shape.h) than
// this collapses no more, nor does any above it. So what must be kept of a node is bounded. It goes by
// the level and the shape alone, and so is the same however the volume is cut.
struct SealingLimits {
  std::size_t clusters = 8, curves = 32;  // from level 5 on; curves: at least 6, those of a disc
  std::size_t clusters_of_smallest = 64;  // at level 4, that of the smallest bricks
};

struct SimplifyParameters {
  bool enabled = true;
  double tolerance = 0.1;  // in the units of the spacing
  Metric metric = Metric::rms;
  Topology topology = Topology::safe;
  QefForm qef = QefForm::qr;
  double singular_threshold = 0.1;  // of the largest singular value (Ju et al. 2002)
  // How far out of a finest cell its vertex is sought, in cells. Stitch puts it back inside; refine,
  // which knows what is around it, may not. (A larger leaf keeps the tolerance inside.)
  double overhang = 0;
  SealingLimits sealing;  // fixed, but for tests
};

struct LabelParameters {
  // each and shared: the samples are labels, and surface.label, isovalue, inside and gradient are
  // not looked at.
  LabelMode mode = LabelMode::off;
  std::shared_ptr<const MaterialRules> rules;  // never null unless mode is off
};

struct ContourParameters {
  Vec3 spacing{1, 1, 1};
  SurfaceParameters surface;
  LabelParameters labels;
  SimplifyParameters simplify;
  Edits edits;  // of the volume, before anything is contoured
};

// Whether each sheet of the surface collapses by itself. Between labels none does.
inline bool collapses_by_sheets(const ContourParameters& parameters) {
  return parameters.simplify.enabled && parameters.simplify.topology == Topology::manifold &&
         parameters.labels.mode != LabelMode::shared;
}

// Samples the stencils of crossings and gradients reach beyond the crossing edge's ends, the halo's
// width: branches, and at the volume's border central differences, are one-sided over three points.
inline constexpr int gradient_halo = 2;
// And beyond that the filter of labels (stages/build/label_field.h).
inline constexpr int label_halo = 2;

}  // namespace voxweld
