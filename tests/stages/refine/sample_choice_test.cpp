// Which samples are left, against a look at each triangle's.
#include "stages/refine/sample_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "random_places.h"
#include "stages/refine/nearest_triangle.h"

namespace voxweld {
namespace {

// Of each third triangle none, of the others up to five, and one has so many that no thread gets fewer.
RefineMesh random_mesh(std::size_t triangles) {
  testing::RandomPlaces random;
  RefineMesh mesh;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const LatticeTriangle shape = random.triangle(-50, 50);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), shape.begin(), shape.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    const std::int32_t samples = t == triangles / 2 ? 40000 : t % 3 == 0 ? 0 : random(1, 5);
    for (std::int32_t s = 0; s < samples; ++s) mesh.samples.push_back({random.point(-60, 60), t});
  }
  return mesh;
}

using Distances = std::map<std::uint32_t, double>;  // of triangles their farthest sample

Distances farthest(const RefineMesh& mesh) {
  Distances most;
  for (const SurfaceSample& s : mesh.samples) {
    double& so_far = most[s.triangle];
    so_far = std::max(so_far, std::sqrt(squared_distance(s.point, mesh.shape(s.triangle))));
  }
  return most;
}

TEST(SampleChoice, KeepsTheFarthestOfEachTriangleAndCountsAll) {
  const RefineMesh mesh = random_mesh(60000);
  ASSERT_GT(mesh.samples.size(), 100000U);
  RefineMesh thinned = mesh;
  RefineCounts counts, plain;
  keep_farthest_samples(thinned, counts);
  for (const SurfaceSample& s : mesh.samples)
    plain.add_distance(std::sqrt(squared_distance(s.point, mesh.shape(s.triangle))));
  EXPECT_EQ(counts.distances, plain.distances);
  EXPECT_EQ(counts.worst, plain.worst);
  EXPECT_EQ(thinned.triangles, mesh.triangles);
  EXPECT_EQ(farthest(thinned), farthest(mesh));
  EXPECT_EQ(thinned.samples.size(), farthest(mesh).size());
  EXPECT_TRUE(std::ranges::is_sorted(thinned.samples, {}, &SurfaceSample::triangle));
}

TEST(SampleChoice, LeavesOutWhatIsNearerThanAnEighthOfTheTolerance) {
  const RefineMesh mesh = random_mesh(3000);
  for (const double tolerance : {0.0, 100.0, 400.0, 2000.0}) {
    RefineMesh thinned = mesh;
    thin_samples(thinned, tolerance);
    Distances far = farthest(mesh);
    std::erase_if(far, [&](const auto& one) { return one.second <= tolerance / 8; });
    EXPECT_EQ(farthest(thinned), far);
    EXPECT_EQ(thinned.samples.size(), far.size());
  }
  RefineMesh thinned = mesh;
  thin_samples(thinned, 400);
  EXPECT_GT(thinned.samples.size(), 100U);
  EXPECT_LT(thinned.samples.size(), farthest(mesh).size() - 100);
}

}  // namespace
}  // namespace voxweld
