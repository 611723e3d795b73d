// Contours a volume that lies in memory as a whole: samples in, meshes out, without files, threads
// or a config. It goes through the same stages as the program, so its meshes are the program's.
//
//   // A ball of radius 20 mm, in samples 0.5 mm apart: distances to its surface, x fastest.
//   const std::int64_t side = 96;
//   std::vector<float> samples;
//   for (std::int64_t z = 0; z < side; ++z)
//     for (std::int64_t y = 0; y < side; ++y)
//       for (std::int64_t x = 0; x < side; ++x)
//         samples.push_back(static_cast<float>(20 - 0.5 * std::hypot(x - 48, y - 48, z - 48)));
//   ContourParameters parameters;
//   parameters.spacing = {0.5, 0.5, 0.5};
//   parameters.simplify.tolerance = 0.05;  // mm, as is all that follows
//   const VolumeContour contour = contour_volume(
//       {SampleType::f32, {side, side, side}, std::as_bytes(std::span(samples))}, parameters);
//   const TileMesh mesh = join_tiles(contour.tiles);
//   for (const LatticePoint& q : mesh.positions)
//     std::printf("v %g %g %g\n", mesh.lattice.coordinate(0, q[0]),
//                 mesh.lattice.coordinate(1, q[1]), mesh.lattice.coordinate(2, q[2]));
//
// Lengths are in the units of ContourParameters::spacing, and sample (0, 0, 0) lies at
// ContourOptions::first.
//
// Memory, beside the samples: the simplified octree of the whole volume, about 200 bytes a vertex
// of it; build_brick_bytes() of one brick while it is built (of labels, build_labels_bytes() as
// well); and the tiles. The program holds a few bricks and one tile at a time in place of them.
//
// All are pure functions: calls from several threads at once are independent.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "stages/build/build_brick.h"
#include "storage/types/tile_mesh.h"
#include "storage/types/top_tree.h"

namespace voxweld {

struct VolumeSamples {
  SampleType type = SampleType::u8;
  Index3 size;                       // samples a side, each 1 .. 2^19 - 1
  std::span<const std::byte> bytes;  // x fastest, tightly packed, native byte order
};

struct ContourOptions {
  int brick_level = 6;  // log2 of the cells a side of a brick, min_brick_level .. max_brick_level
  std::uint64_t tile_vertices = 500000;  // of a tile at most, unless 16^3 cells have more
  double precision = 0.01;               // the output lattice's step at most
  bool normals = true;                   // of the triangles' corners
  Vec3 first{};  // output coordinates of sample (0, 0, 0), multiples of the lattice's step
};

struct VolumeContour {
  std::vector<TileMesh> tiles;        // in Morton order; those without triangles too
  std::vector<PlannedTile> plan;      // of the tiles, in their order
  std::vector<TopLeaf> top;           // leaves above the bricks, in Morton order
  AboveBricks above;                  // the same where each sheet collapses by itself
  BrickCounts counts;                 // summed; leaves and vertices of the final octree
  std::uint64_t collapsed_above = 0;  // nodes above the bricks that took in their children
};

// Preconditions: samples.bytes holds size.x * size.y * size.z of them; labels.mode is not "each"
// (build_label_bricks is for that); of a label volume (surface.label, labels.mode) the samples are
// integers. InputError where the lattice of `options` does not fit the volume (plan_lattice).
VolumeContour contour_volume(const VolumeSamples& samples, const ContourParameters& parameters,
                             const ContourOptions& options = {});

// One mesh of tiles in their order: vertices joined, those of one id, and numbered by first use.
// Takes about three times what the mesh does. InputError past 2^32 - 1 vertices.
TileMesh join_tiles(std::span<const TileMesh> tiles);

// The same in its parts, for who keeps the octree and builds some of its bricks anew.
struct VolumeBricks {
  Index3 size;  // samples a side of the volume
  ContourParameters parameters;
  ContourOptions options;
  std::map<std::uint64_t, BrickOctree> octrees = {};  // by Morton code; those not there are outside

  BrickGrid grid() const;
};
VolumeBricks build_bricks(const VolumeSamples& samples, const ContourParameters& parameters,
                          const ContourOptions& options);
// Of each label by itself (labels.mode = "each"): bit for bit the bricks of a volume that holds
// that label alone.
std::map<Material, VolumeBricks> build_label_bricks(const VolumeSamples& samples,
                                                    const ContourParameters& parameters,
                                                    const ContourOptions& options);
VolumeContour contour_bricks(const VolumeBricks& bricks);
// All but the tiles.
VolumeContour plan_tiles(const VolumeBricks& bricks);
// tile: one of plan.plan. plan: of the same bricks.
TileMesh stitch_tile(const VolumeBricks& bricks, const VolumeContour& plan,
                     const PlannedTile& tile);

}  // namespace voxweld
