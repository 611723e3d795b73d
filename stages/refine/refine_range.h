// Refine: repairs what intersects and collapses edges, cube by cube.
//
// A triangle is at home in the cube of its corner with the lowest id. It may be changed in a cube
// only if all of its corners lie there; all others are fixed in that pass.
#pragma once

#include <optional>
#include <span>

#include "stages/contouring/normal_clusters.h"
#include "stages/refine/cube_lattice.h"
#include "storage/types/collapse_survey.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// mend: of repair only what is done about triangles that intersect (mend_box.h).
enum class RefineMode : std::uint8_t { repair, collapse, mend };
enum class IntersectionRule : std::uint8_t { none, report, ignore };

// A cube that more triangles meet is done in eight parts, so that memory is bounded.
inline constexpr std::size_t most_part_triangles = std::size_t{1} << 16;

// How many normals a vertex has, by the cosines of angles.
struct NormalRule {
  // Of vertices that become one: those within this angle of their mean become one, too.
  float cosine = cluster_cosine;
  // A triangle that is further than this from all normals of its vertex (40 degrees) is one more.
  float own_cosine = 0.766f;
};

struct RefineParameters {
  RefineMode mode = RefineMode::collapse;
  IntersectionRule intersections = IntersectionRule::none;
  // Lattice steps: how far a sample may be from the triangle that stands for it, and how far where
  // something is mended.
  double tolerance = 0;
  double reach = 0;
  // And where a vertex goes where it best lies, if not the tolerance.
  std::optional<double> places = {};
  // Where the volume's border is open: the box of its samples. Elsewhere no vertex at a mesh's end is
  // changed.
  std::optional<LatticeBox> samples = {};
  // What leaves this box is fixed too, and all beyond it.
  std::optional<LatticeBox> within = {};
  NormalRule normals = {};
  // Where edges are collapsed, coordinates of what moves become multiples of this power of two.
  std::int32_t grain = 1;
  // Whether vertices go where they best lie first, and edges flip to agree with normals
  // (vertex_places.h).
  bool settles = true;
  // Whether distances of samples are counted when a cube is done.
  bool counts_distances = true;
  // Triangles in the cubes, or parts of one, that are refined at the same time, unless it is one alone.
  // Memory grows with it, and nothing else depends on it.
  std::size_t at_once = most_part_triangles;
};

// What was done and what came of it; sums over cubes. Plain data: artifacts hold it as it is.
struct RefineCounts {
  std::uint64_t cubes = 0;  // with something in them
  std::uint64_t collapses = 0, moves = 0, flips = 0;
  std::uint64_t pairs_before = 0;  // of triangles that intersect; each is counted once in a pass
  std::uint64_t pairs_left = 0;
  double worst = 0;  // the largest distance of a sample to its triangle, lattice steps
  // Samples by their distance: bin b holds those from 2^((b - 1) / 4 - 8) to 2^(b / 4 - 8) lattice
  // steps, the first all below, the last all above.
  std::array<std::uint64_t, 96> distances{};

  void add(const RefineCounts& other);
  void add_distance(double distance);
  // Of a sample that is counted anew.
  void remove_distance(double distance);
  // Of a mesh, parts of which are as mend has counted them.
  RefineCounts patched_by(const RefineCounts& mended) const;
  // The distance that this part of all samples does not exceed, to the next bin's border.
  double quantile(double part) const;

 private:
  std::uint64_t& bin(double distance);
};

// Refines the cubes of `own`. Returns what is at home in them, with the vertices that it uses:
// triangles by their home's code, their home and their ids, vertices by first use. Nothing else of
// `mesh` is looked at, so the result is the same whatever else it holds and in whatever order.
//
// Preconditions: mesh holds all triangles that are at home in cubes of `own`, and all whose boxes
// meet the box of such a cube or of such a triangle. So it holds the whole star of each vertex there.
RefineMesh refine_range(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own,
                        const RefineParameters& parameters, RefineCounts& counts);

// Of the same triangles, how many would be left with each of these tolerances in place of the
// parameters' own. Precondition beside those of refine_range: they ascend. others: of the other pass.
CollapseSurvey survey_range(const RefineMesh& mesh, const CubeLattice& cubes,
                            const CubeLattice& others, const CubeRange& own,
                            const RefineParameters& parameters, std::span<const double> tolerances);

// The cube a triangle is at home in.
Index3 home_of(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& cubes);

// How much a mesh holds.
struct MeshSize {
  std::uint64_t vertices = 0, triangles = 0, samples = 0;
  std::uint64_t sided = 0;  // triangles that have sides
};
// Bytes refine_range takes at most, its result included, beside its argument, which is `all`. own: of
// that what is at home in its range, with as many samples as there may be in the end. at_once: the
// parameters'.
std::uint64_t refine_bytes(const MeshSize& all, const MeshSize& own,
                           std::size_t at_once = most_part_triangles);

}  // namespace voxweld
