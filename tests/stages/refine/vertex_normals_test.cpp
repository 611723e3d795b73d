// How many normals vertices have once edges are collapsed: one on what is smooth, several at creases.
#include "stages/refine/vertex_normals.h"

#include <gtest/gtest.h>

#include "stages/refine/refine_range.h"
#include "tests/stages/refine/volume_mesh.h"

namespace voxweld {
namespace {

constexpr std::int64_t side = 32;

// distance(offset from the middle): to the surface, positive outside.
template <class F>
RefineMesh collapsed(F&& distance) {
  const testing::MemoryVolume volume =
      testing::MemoryVolume::made<float>(splat(side), SampleType::f32, [&](Index3 at) {
        constexpr double shift = 15.37;  // on no sample
        return static_cast<float>(
            distance(Vec3{static_cast<double>(at.x) - shift, static_cast<double>(at.y) - shift,
                          static_cast<double>(at.z) - shift}));
      });
  const testing::VolumeMesh made = testing::mesh_of(volume, 0.1);
  RefineMesh mesh = made.mesh;
  testing::refine_all(mesh, made.frame, testing::refining(made.frame, 0.1, RefineMode::collapse),
                      [](const RefineCounts&) {});
  return mesh;
}

double normals_a_vertex(const RefineMesh& mesh) {
  std::size_t count = 0;
  for (const auto& packed : mesh.normals)
    for (const PackedNormal one : packed) count += one != no_normal ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(mesh.normals.size());
}

// Saddles, on which triangles stand up to 25 degrees off the normals of their corners. Where the volume's
// border cuts them there are edges, at which vertices have two.
TEST(VertexNormals, OfASmoothSurfaceAreMostlyOne) {
  constexpr double wave = 0.35;
  const RefineMesh mesh = collapsed([](Vec3 p) {
    const Vec3 q = p * wave;
    return (std::sin(q.x) * std::cos(q.y) + std::sin(q.y) * std::cos(q.z) +
            std::sin(q.z) * std::cos(q.x)) /
           wave;
  });
  EXPECT_LT(mesh.normals.size(), 2500u) << "it is not collapsed";
  EXPECT_LT(normals_a_vertex(mesh), 1.4);
}

TEST(VertexNormals, OfABoxAreTwoOrThree) {
  const RefineMesh mesh = collapsed([](Vec3 p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 9.2;
  });
  ASSERT_FALSE(mesh.normals.empty());
  EXPECT_GT(normals_a_vertex(mesh), 1.9) << "most of what is left lies on edges";
}

}  // namespace
}  // namespace voxweld
