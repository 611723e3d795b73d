// Refine on complexes between labels: balanced, of the same topology, without intersections.
// VOXWELD_VOLUMES: how many volumes (default 8).
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "stages/exact/intersections.h"
#include "stages/refine/edit_mesh.h"
#include "stages/refine/refine_range.h"
#include "tests/stages/refine/plain_nearest.h"
#include "tests/stages/refine/refine_ranges.h"
#include "tests/stages/refine/torus.h"
#include "tests/stages/refine/volume_mesh.h"
#include "tests/support/label_cases.h"
#include "tests/support/label_complex.h"
#include "tests/support/random_volumes.h"

namespace voxweld {
namespace {

struct LabelCase {
  bool noise = false;  // else cells of random points
  unsigned labels = 4;
  unsigned seed = 0;
  double tolerance = 0.1;
  RefineMode mode = RefineMode::collapse;
};

std::ostream& operator<<(std::ostream& out, const LabelCase& c) {
  return out << (c.noise ? "noise " : "cells ") << c.labels << " labels, seed " << c.seed
             << ", tolerance " << c.tolerance
             << (c.mode == RefineMode::repair ? ", repair" : ", collapse");
}

testing::VolumeMesh mesh_of_labels(const LabelCase& c) {
  const testing::MemoryVolume volume =
      c.noise ? testing::noise({12, 13, 12}, c.labels, c.seed)
              : testing::voronoi(24 + c.seed % 9, 3 * c.labels, c.labels, c.seed);
  return testing::mesh_of(volume, testing::shared_labels(c.tolerance));
}

// By places alone, as who reads the files has it.
testing::Complex complex_of_mesh(const RefineMesh& mesh) {
  testing::Complex complex;
  std::map<LatticePoint, std::uint32_t> number;
  for (const auto& triangle : mesh.triangles) {
    testing::Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] =
          number.try_emplace(mesh.positions[triangle[k]], static_cast<std::uint32_t>(number.size()))
              .first->second;
    complex.mesh.triangles.push_back(corners);
  }
  complex.mesh.vertices.resize(number.size());
  complex.pairs = mesh.sides;
  return complex;
}

// Of the lines where sheets meet.
struct Lines {
  std::size_t pieces = 0;  // of lines that meet one
  std::int64_t euler = 0;
  std::map<std::size_t, std::size_t> ends;     // how many vertices are where so many of them end
  std::map<std::size_t, std::int64_t> sheets;  // of so many sheets: edges less vertices between
  friend bool operator==(const Lines&, const Lines&) = default;
};

Lines lines_of(const testing::Complex& complex) {
  std::map<std::array<std::uint32_t, 2>, std::size_t> around;
  for (const testing::Triangle& t : complex.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      ++around[{low, high}];
    }
  std::map<std::uint32_t, std::vector<std::size_t>>
      at;  // of each vertex its lines, by their sheets
  std::map<std::uint32_t, std::uint32_t> parent;
  const auto root = [&](std::uint32_t v) {
    while (parent.try_emplace(v, v).first->second != v) v = parent[v];
    return v;
  };
  Lines lines;
  for (const auto& [edge, count] : around) {
    if (count == 2) continue;
    --lines.euler;
    ++lines.sheets[count];
    for (const std::uint32_t v : edge) at[v].push_back(count);
    parent[root(edge[0])] = root(edge[1]);
  }
  for (const auto& [v, sheets] : at) {
    ++lines.euler;
    lines.pieces += root(v) == v ? 1 : 0;
    if (sheets.size() == 2 && sheets[0] == sheets[1])
      --lines.sheets[sheets[0]];
    else
      ++lines.ends[sheets.size()];
  }
  return lines;
}

std::size_t pairs_in(const RefineMesh& mesh) {
  std::size_t pairs = 0;
  each_intersection({mesh.positions, mesh.triangles},
                    [&](std::uint32_t, std::uint32_t) { ++pairs; });
  return pairs;
}

std::size_t same_corners(const testing::Complex& complex) {
  std::set<testing::Triangle> seen;
  std::size_t same = 0;
  for (testing::Triangle t : complex.mesh.triangles) {
    std::sort(t.begin(), t.end());
    same += seen.insert(t).second ? 0 : 1;
  }
  return same;
}

struct LabelTotals {
  std::uint64_t meshes = 0, before = 0, left = 0, triangles = 0, triangles_left = 0;
};

void check(const LabelCase& c, LabelTotals& totals) {
  SCOPED_TRACE(::testing::PrintToString(c));
  const testing::VolumeMesh made = mesh_of_labels(c);
  RefineMesh mesh = made.mesh;
  const testing::Complex before = complex_of_mesh(mesh);
  EXPECT_EQ(before.mesh.vertices.size(), mesh.positions.size());
  EXPECT_EQ(testing::unbalanced(before), 0u);
  EXPECT_EQ(same_corners(before), 0u);
  const std::size_t pairs = pairs_in(mesh);
  const RefineParameters refine = testing::refining(made.frame, c.tolerance, c.mode);
  std::size_t left = pairs;
  testing::refine_all(mesh, made.frame, refine, [&](const RefineCounts& counts) {
    left = pairs_in(mesh);
    EXPECT_EQ(counts.pairs_left, left);
    if (c.mode == RefineMode::collapse && pairs == 0 && c.tolerance < 100) {
      EXPECT_LE(counts.worst, refine.tolerance * (1 + 1e-9));
    }
  });
  ASSERT_EQ(mesh.sides.size(), mesh.triangles.size());
  const testing::Complex after = complex_of_mesh(mesh);
  EXPECT_EQ(after.mesh.vertices.size(), mesh.positions.size()) << "two vertices at one place";
  EXPECT_EQ(testing::unbalanced(after), 0u);
  EXPECT_EQ(same_corners(after), 0u);
  EXPECT_EQ(testing::topology(after), testing::topology(before));
  EXPECT_EQ(testing::connected_components(after.mesh.triangles),
            testing::connected_components(before.mesh.triangles));
  EXPECT_EQ(testing::euler_characteristic(after.mesh.triangles),
            testing::euler_characteristic(before.mesh.triangles));
  const Lines lines = lines_of(before), lines_left = lines_of(after);
  EXPECT_EQ(lines_left.pieces, lines.pieces);
  EXPECT_EQ(lines_left.euler, lines.euler);
  EXPECT_EQ(lines_left.ends, lines.ends);
  EXPECT_EQ(lines_left.sheets, lines.sheets);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_FALSE(has_no_area(mesh.shape(t)));
  EXPECT_LE(mesh.triangles.size(), before.mesh.triangles.size());
  ++totals.meshes;
  totals.before += pairs;
  totals.left += left;
  totals.triangles += before.mesh.triangles.size();
  totals.triangles_left += mesh.triangles.size();
}

// Eight cubes in the first pass, 27 in the second: lines cross their borders.
TEST(LabelRefine, NeitherTheRangesNorTheOrderMatter) {
  const testing::VolumeMesh made =
      testing::mesh_of(testing::voronoi(100, 40, 7, 3), testing::shared_labels(0.2));
  RefineMesh mesh = made.mesh;
  const RefineParameters refine = testing::refining(made.frame, 0.4, RefineMode::collapse);
  for (const int pass : {0, 1}) {
    const auto in = [&](const RefineMesh& from, const std::vector<std::uint64_t>& codes,
                        bool all_is_given) {
      return testing::refine_in(from, made.frame, pass, testing::cut_at(codes), refine,
                                all_is_given);
    };
    const testing::Refined one = in(mesh, {}, true);
    EXPECT_GT(one.counts.cubes, 7u);
    EXPECT_LT(one.mesh.triangles.size(), mesh.triangles.size() * 9 / 10);
    for (const testing::Refined& other :
         {in(mesh, {1, 4, 6}, true), in(mesh, {1, 4, 6}, false), in(mesh, {3}, false),
          in(testing::shuffled(mesh, 1), {}, true)}) {
      EXPECT_TRUE(testing::same_mesh(one.mesh, other.mesh)) << pass;
      EXPECT_EQ(one.counts.collapses, other.counts.collapses);
      EXPECT_EQ(one.counts.pairs_left, other.counts.pairs_left);
      EXPECT_EQ(one.counts.distances, other.counts.distances);
    }
    mesh = one.mesh;
  }
}

// The mesh of stitch, cut into a tile anew, is shaded as it was. Stitch knows of a vertex between two
// labels which side is out; of a mesh that was refined nobody does, which seldom tells.
TEST(LabelRefine, WithoutAChangeShadingIsThatOfStitch) {
  for (const std::uint64_t tolerance : {1, 4}) {
    ContourParameters parameters = testing::shared_labels(0.1 * static_cast<double>(tolerance));
    parameters.simplify.overhang = 1;  // as mesh_of has it
    const testing::MemoryVolume volume = testing::voronoi(40, 14, 5, 2);
    const TileMesh stitched = join_tiles(contour_volume(volume, parameters).tiles);
    const testing::VolumeMesh made = testing::mesh_of(volume, parameters);
    const TileMesh again =
        to_tile_mesh(made.mesh, {6, {}}, made.frame.lattice, tile_blocks(made.frame));
    const auto corners = [](const TileMesh& mesh) {
      std::map<std::pair<std::array<VertexId, 3>, VertexId>, Vec3> normals;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<VertexId, 3> ids{};
        for (std::size_t k = 0; k < 3; ++k) ids[k] = mesh.ids[mesh.triangles[t][k]];
        std::sort(ids.begin(), ids.end());
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = mesh.triangles[t][k];
          normals[{ids, mesh.ids[v]}] = mesh.corner_normals[t][k].of(mesh.normals[v]);
        }
      }
      return normals;
    };
    const auto before = corners(stitched), after = corners(again);
    ASSERT_EQ(before.size(), after.size());
    std::size_t other = 0;
    for (const auto& [corner, normal] : before) other += after.at(corner) == normal ? 0 : 1;
    EXPECT_LE(other * 50, before.size()) << "where triangles fold over";
  }
}

// Of each vertex that there was, near a triangle of each pair of labels that met there.
TEST(LabelRefine, EachSheetStaysNearWhereItWas) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const testing::VolumeMesh made = mesh_of_labels({false, 3 + seed, seed, 0.1});
    RefineParameters refine = testing::refining(made.frame, 0.6, RefineMode::collapse);
    refine.intersections = IntersectionRule::ignore;
    RefineMesh mesh = made.mesh;
    mesh.aims.clear();  // to which they would go from places that are none of the surface
    testing::refine_all(mesh, made.frame, refine, [](const RefineCounts&) {});
    std::map<MaterialPair, std::vector<LatticeTriangle>> sheets;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      sheets[mesh.sides[t]].push_back(mesh.shape(t));
    double most = 0;
    for (std::size_t t = 0; t < made.mesh.triangles.size(); ++t)
      for (const LatticePoint& p : made.mesh.shape(t))
        most = std::max(most, testing::nearest_triangle(p, sheets[made.mesh.sides[t]]).squared);
    EXPECT_LE(std::sqrt(most), refine.tolerance * (1 + 1e-9)) << seed;
    EXPECT_GE(std::sqrt(most), refine.tolerance / 2) << seed;
    EXPECT_LT(mesh.triangles.size(), made.mesh.triangles.size() / 5) << seed;
  }
}

TEST(LabelRefine, RandomVolumesStaySoundAndLoseTheirIntersections) {
  const unsigned count = testing::volumes_to_try(8);
  for (const bool noise : {false, true})
    for (const RefineMode mode : {RefineMode::collapse, RefineMode::repair})
      for (const double tolerance : {0.1, 0.5, 1e6}) {
        LabelTotals totals;
        for (unsigned seed = noise ? 3 : 0; seed < count; seed += noise ? 4 : 1)
          if (mode == RefineMode::collapse || seed % 2 == 1)
            check({noise, 2 + seed % 5, seed, tolerance, mode}, totals);
        std::printf("%s %s at %g: %llu meshes, triangles %llu -> %llu, pairs %llu -> %llu\n",
                    noise ? "noise" : "cells", mode == RefineMode::repair ? "repair" : "collapse",
                    tolerance, static_cast<unsigned long long>(totals.meshes),
                    static_cast<unsigned long long>(totals.triangles),
                    static_cast<unsigned long long>(totals.triangles_left),
                    static_cast<unsigned long long>(totals.before),
                    static_cast<unsigned long long>(totals.left));
        EXPECT_EQ(totals.left, 0u);
      }
}

}  // namespace
}  // namespace voxweld
