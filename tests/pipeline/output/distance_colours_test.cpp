// Places that a picture knows, and colours by the distance to another mesh.
#include "pipeline/output/distance_colours.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/output/export.h"
#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

// z rises by a tenth of x, from 0 to 1.
DecodedMesh ramp() {
  DecodedMesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 1}, {10, 10, 1}, {0, 10, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}
// In z = 0, and farther than the ramp.
DecodedMesh ground() {
  DecodedMesh mesh;
  mesh.positions = {{-20, -20, 0}, {40, -20, 0}, {40, 40, 0}, {-20, 40, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

constexpr RenderOptions from_above{
    .width = 160, .height = 120, .azimuth = 0, .elevation = 90, .field_of_view = 0, .places = true};

Renderer drawn(const DecodedMesh& mesh, const RenderOptions& options) {
  Renderer renderer(bounds_of(std::span(&mesh, 1)), options);
  renderer.draw(mesh);
  return renderer;
}

struct Colour {
  int r, g, b;
};
Colour colour_at(const Image& image, int x, int y) {
  const auto at = 3 * static_cast<std::size_t>(y * image.width + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

class DistanceColours : public ::testing::Test {
 protected:
  std::filesystem::path file(const DecodedMesh& mesh) const {
    const auto path = folder_.path() / "reference.ply";
    write_exported(path, exported_mesh(mesh, path));
    return path;
  }
  testing::TempDirectory folder_;
};

TEST(RenderPlaces, LieOnTheMeshFromAnyEye) {
  for (const double view : {0.0, 40.0})
    for (const double elevation : {90.0, 25.0}) {
      RenderOptions options = from_above;
      options.field_of_view = view;
      options.elevation = elevation;
      const Renderer renderer = drawn(ramp(), options);
      std::size_t seen = 0;
      for (const Renderer::Place& p : renderer.places()) {
        if (std::isnan(p[0])) continue;
        ++seen;
        ASSERT_NEAR(p[2], p[0] / 10, 1e-5);
        ASSERT_TRUE(p[0] > -1e-4F && p[0] < 10.0001F && p[1] > -1e-4F && p[1] < 10.0001F);
      }
      EXPECT_GT(seen, 3000u) << view << " " << elevation;
    }
}

TEST_F(DistanceColours, AreOfTheDistanceAtEachPlace) {
  const DecodedMesh mesh = ramp();
  Renderer renderer = drawn(mesh, from_above);
  const ReferenceMesh reference(file(ground()), bounds_of(std::span(&mesh, 1)));
  const ShownDistances shown = reference.colour(renderer, std::nullopt);
  EXPECT_NEAR(shown.mean, 0.5, 0.01);
  EXPECT_NEAR(shown.p99, 0.99, 0.01);
  EXPECT_NEAR(shown.most, 1, 0.01);
  EXPECT_EQ(shown.end, shown.p99);
  const Image image = renderer.finish();
  // The ramp is in the middle, as high as 0.7 of the picture, x to the right.
  const Colour near = colour_at(image, 45, 60), middle = colour_at(image, 80, 60),
               far = colour_at(image, 115, 60);
  EXPECT_GT(near.b, near.g) << "purple";
  EXPECT_GT(middle.g, middle.r) << "green";
  EXPECT_GT(middle.b, middle.r);
  EXPECT_GT(far.r, far.b) << "yellow";
  EXPECT_GT(far.g, far.b);
  EXPECT_GT(far.r + far.g, near.r + near.g + 60);
}

TEST_F(DistanceColours, EndWhereTheyAreToldTo) {
  const DecodedMesh mesh = ramp();
  Renderer renderer = drawn(mesh, from_above);
  const ShownDistances shown =
      ReferenceMesh(file(ground()), bounds_of(std::span(&mesh, 1))).colour(renderer, 100);
  EXPECT_EQ(shown.end, 100);
  const Image image = renderer.finish();
  const Colour far = colour_at(image, 115, 60);
  EXPECT_GT(far.b, far.g) << "one hundredth is purple still";
}

TEST_F(DistanceColours, OfAMeshToItselfAreNone) {
  const DecodedMesh mesh = ramp();
  Renderer renderer = drawn(mesh, from_above);
  const ShownDistances shown =
      ReferenceMesh(file(mesh), bounds_of(std::span(&mesh, 1))).colour(renderer, std::nullopt);
  EXPECT_LT(shown.most, 10 * 0x1p-21);
}

TEST_F(DistanceColours, NeedTriangles) {
  const DecodedMesh mesh = ramp();
  DecodedMesh none = mesh;
  none.triangles.clear();
  EXPECT_THROW(ReferenceMesh(file(none), bounds_of(std::span(&mesh, 1))), InputError);
}

}  // namespace
}  // namespace voxweld
