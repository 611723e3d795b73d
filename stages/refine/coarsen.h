// Coarser versions of parts of a mesh, for levels of detail that fit each other at any mix.
//
// A node is a cube of cells. What of the mesh lies in it is collapsed with a larger tolerance, and what
// leaves it stays as it is, to the bit. So does the part of the next node, at whatever level that is
// shown: both keep the same triangles between them, and there is no crack to patch. Borders stay fine:
// what that costs is small beside what lies inside, as long as a node has many triangles.
//
// Simplifying groups with locked borders, and those borders inside of the next group, is the way of
// Karis, Stubbe and Wihlidal ("A Deep Dive into Nanite Virtualized Geometry", SIGGRAPH 2021). Groups
// here are nodes of one octree, so that what replaces what is a tree, as clients of 3D Tiles need it.
#pragma once

#include <optional>

#include "stages/refine/refine_range.h"

namespace voxweld {

// Normals of a vertex of a coarse level become one where they lie within 40 degrees of their mean, and
// only triangles that face away add their own: a crease of 80 degrees or more stays sharp, and what is
// smooth looks so, though triangles that bridge it turn further than those of the mesh itself. Grouped
// within 25 degrees, with triangles that stand further off on their own, a vertex of the gyroid (512^3)
// had 2.6 points at level 1 and 4.2 at level 2, of which the tiles' bytes were half; within 40, with no
// triangle on its own, it had 1.02 and 1.14.
inline constexpr float level_normal_cosine = 0.766f;
inline constexpr float level_own_cosine = 0;

struct CoarseNode {
  CellKey cell;      // a triangle is at home in it as in a tile: belongs_to()
  bool all = false;  // it holds the whole mesh: then nothing is locked
  // Of the mesh's tolerance. Edges of a smooth surface get twice as long with two. Where tiles are twice as
  // wide then, they have as many triangles as before.
  int doublings = 2;
};

// The tolerance of a node, from that of the mesh itself.
double level_tolerance(double finest, int doublings);

// What coordinates of vertices that move become multiples of, a power of two: a twelfth of the tolerance
// or less, since more bits say nothing and cost bytes. tolerance: of the level, in lattice steps.
std::int32_t level_grain(double tolerance);

// mesh: all triangles at home in the node, and of others those whose boxes meet its box, with samples as
// thin_samples() leaves them, since all there are will be looked after. In the end one is left for each triangle at
// most, the farthest: so there are no more at coarse levels.
// parameters: those of the mesh itself; its mode is taken for collapse. Returns the triangles at home,
// refined. counts: what was done, and how far samples lie off.
RefineMesh coarsen(RefineMesh mesh, const RefineFrame& frame, const CoarseNode& node,
                   const RefineParameters& parameters, RefineCounts& counts);

// Bytes it takes at most, its result included, beside the mesh.
std::uint64_t coarsen_bytes(const MeshSize& all);

}  // namespace voxweld
