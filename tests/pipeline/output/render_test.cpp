#include "pipeline/output/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

DecodedMesh decoded(const TileMesh& mesh, bool normals) {
  return decode_draco(encode_draco(mesh, {.normals = normals}).bytes);
}

DecodedMesh torus(bool normals = true) {
  return decoded(
      testing::make_torus({.around = 96, .across = 48, .creased = false}, testing::small_lattice()),
      normals);
}

struct Pixels {
  std::size_t background = 0, front = 0, back = 0;
};

Pixels count(const Image& image) {
  Pixels n;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    const int r = image.rgb[i], g = image.rgb[i + 1], b = image.rgb[i + 2];
    if (b > r)
      ++n.background;
    else if (r > 3 * g / 2)
      ++n.back;
    else
      ++n.front;
  }
  return n;
}

// VOXWELD_PICTURES names a folder to look at what the tests render.
void keep(const Image& image, const std::string& name) {
  const char* folder = std::getenv("VOXWELD_PICTURES");
  if (folder == nullptr) return;
  std::string ppm = "P6\n" + std::to_string(image.width) + " " + std::to_string(image.height) +
                    "\n255\n" + std::string(image.rgb.begin(), image.rgb.end());
  write_whole_file(std::filesystem::path(folder) / (name + ".ppm"), as_bytes(ppm),
                   Durability::rename_only);
}

Image render_mesh(std::span<const DecodedMesh> meshes, const RenderOptions& options) {
  Renderer renderer(bounds_of(meshes), options);
  for (const DecodedMesh& mesh : meshes) renderer.draw(mesh);
  return renderer.finish();
}

constexpr RenderOptions small{.width = 320, .height = 240};

TEST(Render, ShowsTheOutsideOfAClosedMeshOnly) {
  for (const bool normals : {false, true}) {
    const DecodedMesh mesh = torus(normals);
    for (const double view : {30.0, 0.0}) {
      RenderOptions options = small;
      options.field_of_view = view;
      const Image image = render_mesh(std::span(&mesh, 1), options);
      ASSERT_EQ(image.rgb.size(), 3u * 320 * 240);
      const Pixels n = count(image);
      EXPECT_GT(n.front, 9000u);
      EXPECT_GT(n.background, 20000u);
      EXPECT_EQ(n.back, 0u);
      keep(image,
           std::string("torus") + (normals ? "-smooth" : "-flat") + (view > 0 ? "" : "-ortho"));
    }
  }
}

TEST(Render, BacksOfAClosedMeshAreHiddenAnyway) {
  const DecodedMesh mesh = torus();
  RenderOptions without = small;
  without.backs = false;
  EXPECT_TRUE(render_mesh(std::span(&mesh, 1), small).rgb ==
              render_mesh(std::span(&mesh, 1), without).rgb);
  // Of one that is cut open they are missing.
  RenderOptions cut = small;
  const MeshBounds bounds = bounds_of(std::span(&mesh, 1));
  cut.cut[2] = (bounds.lo.z + bounds.hi.z) / 2;
  EXPECT_GT(count(render_mesh(std::span(&mesh, 1), cut)).back, 0u);
  cut.backs = false;
  EXPECT_EQ(count(render_mesh(std::span(&mesh, 1), cut)).back, 0u);
}

TEST(Render, InsideOutAndHolesShowRed) {
  DecodedMesh mesh = torus();
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const Pixels n = count(render_mesh(std::span(&mesh, 1), small));
  EXPECT_LT(n.front, 500u);  // blended with the background along the outline
  EXPECT_GT(n.back, 9000u);
  mesh = torus();
  std::erase_if(mesh.triangles, [](const auto& t) { return t[0] % 3 == 0; });
  const Image holes = render_mesh(std::span(&mesh, 1), small);
  EXPECT_GT(count(holes).back, 500u);
  keep(holes, "torus-holes");
}

TEST(Render, TilesOneByOneGiveTheSamePicture) {
  const TileMesh whole = testing::make_torus({.creased = false}, testing::small_lattice());
  std::vector<DecodedMesh> tiles;
  for (const TileMesh& tile : testing::cut_into_tiles(whole, 3))
    tiles.push_back(decoded(tile, false));
  const Image together = render_mesh(tiles, small);
  Renderer renderer(bounds_of(tiles), small);
  for (auto tile = tiles.rbegin(); tile != tiles.rend(); ++tile) renderer.draw(*tile);
  EXPECT_EQ(together.rgb, renderer.finish().rgb);
}

TEST(Render, CubeFacesTakeTheirOwnLight) {
  const DecodedMesh cube =
      decoded(testing::make_cube(testing::small_lattice(), {1, 1, 1}, 8, 3), true);
  const Image image = render_mesh(std::span(&cube, 1), small);
  keep(image, "cube");
  std::set<std::array<std::uint8_t, 3>> colours;
  for (std::size_t y = 100; y < 140; ++y)
    for (std::size_t x = 120; x < 200; ++x) {
      const std::size_t at = 3 * (y * 320 + x);
      colours.insert({image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]});
    }
  EXPECT_GE(colours.size(), 3u);
  EXPECT_LE(colours.size(), 60u);  // three flat faces and their blended borders
}

TEST(Render, ZoomAndCentreCropAndEmptyIsBackground) {
  const DecodedMesh mesh = torus();
  RenderOptions options = small;
  options.zoom = 4;
  options.centre = Vec3{32, 20, 20};
  EXPECT_GT(count(render_mesh(std::span(&mesh, 1), options)).front, 30000u);
  const Pixels n = count(render_mesh(std::span<const DecodedMesh>{}, small));
  EXPECT_EQ(n.background, 320u * 240);
}

// Of a label's own mesh the front has the label's colour, the back shows that it is one.
TEST(Render, LabelsHaveTheirColours) {
  const DecodedMesh mesh = torus();
  const auto brightest = [&](const MaterialTable& given, std::optional<Material> label) {
    Renderer renderer(bounds_of(std::span(&mesh, 1)), small);
    renderer.set_colours(given);
    renderer.draw(mesh, label);
    const Image image = renderer.finish();
    const std::size_t middle = 3 * (static_cast<std::size_t>(image.height / 2 + 40) * 320 + 160);
    return std::array{image.rgb[middle], image.rgb[middle + 1], image.rgb[middle + 2]};
  };
  MaterialTable red;
  red.entries = {{7, "seven", MaterialColor{255, 0, 0}}};
  const auto given = brightest(red, 7);
  EXPECT_GT(given[0], 100);
  EXPECT_LT(given[1], 60);
  EXPECT_LT(given[2], 60);
  EXPECT_NE(brightest(red, 8), given);
  EXPECT_NE(brightest(red, 8), brightest(red, 9));
  EXPECT_NE(brightest(red, 8), brightest(red, {}));
  EXPECT_EQ(brightest({}, {}), brightest(red, {}));
}

// The cut goes through triangles: with perspective too it lies where it is asked for.
TEST(Render, CutsLieAtTheirPlace) {
  const OutputLattice lattice = testing::small_lattice();
  const DecodedMesh cube = decoded(testing::make_cube(lattice, {4, 4, 4}, 16), true);
  const auto rows = [&](std::optional<double> top, double view) {
    RenderOptions options = small;
    options.azimuth = options.elevation = 0;
    options.field_of_view = view;
    options.cut[2] = top;
    const Image image = render_mesh(std::span(&cube, 1), options);
    keep(image, "cut");
    std::size_t drawn = 0;
    for (std::size_t y = 0; y < 240; ++y) {
      const std::size_t at = 3 * (y * 320 + 160);
      drawn += image.rgb[at + 2] > image.rgb[at] ? 0 : 1;
    }
    return static_cast<double>(drawn);
  };
  EXPECT_NEAR(rows(4.0 + 16 * 0.75, 0) / rows({}, 0), 0.75, 0.02);
  // From in front a quarter of the near side goes, and what is behind it shows the inside, red.
  EXPECT_NEAR(rows(4.0 + 16 * 0.75, 40) / rows({}, 40), 0.75, 0.15);
  EXPECT_EQ(rows(3.9, 0), 0);
}

TEST(Render, EdgesAreDarkLinesWhereTrianglesMeet) {
  const DecodedMesh cube =
      decoded(testing::make_cube(testing::small_lattice(), {4, 4, 4}, 16), true);
  RenderOptions options = small;
  options.azimuth = options.elevation = options.field_of_view = 0;
  const Image plain = render_mesh(std::span(&cube, 1), options);
  options.edges = true;
  const Image edges = render_mesh(std::span(&cube, 1), options);
  keep(edges, "edges");
  std::size_t darker = 0, same = 0;
  for (std::size_t i = 0; i < plain.rgb.size(); i += 3) {
    if (plain.rgb[i + 2] > plain.rgb[i]) continue;  // sky
    if (edges.rgb[i] + 40 < plain.rgb[i])
      ++darker;
    else
      same += edges.rgb[i] == plain.rgb[i] ? 1 : 0;
  }
  // The outline of a square and a diagonal of it.
  const double side = std::sqrt(static_cast<double>(darker + same));
  EXPECT_GT(static_cast<double>(darker), 3 * side);
  EXPECT_LT(static_cast<double>(darker), 8 * side);
}

TEST(Render, TransparentWhereThereIsNoMesh) {
  const DecodedMesh mesh = torus();
  RenderOptions options = small;
  EXPECT_TRUE(render_mesh(std::span(&mesh, 1), options).alpha.empty());
  const Image opaque = render_mesh(std::span(&mesh, 1), options);
  options.transparent = true;
  const Image image = render_mesh(std::span(&mesh, 1), options);
  ASSERT_EQ(image.alpha.size(), 320u * 240);
  EXPECT_EQ(image.alpha.front(), 0);
  std::set<int> levels;
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    levels.insert(image.alpha[i]);
    if (image.alpha[i] < 255) continue;
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(image.rgb[3 * i + k], opaque.rgb[3 * i + k]);
  }
  EXPECT_EQ(levels, (std::set<int>{0, 64, 128, 191, 255}));  // of 2 x 2 samples
}

TEST(Render, RefusesOptionsOutOfRange) {
  const auto refused = [](auto change) {
    RenderOptions options = small;
    change(options);
    EXPECT_THROW(render_mesh(std::span<const DecodedMesh>{}, options), InputError);
  };
  refused([](RenderOptions& o) { o.width = 0; });
  refused([](RenderOptions& o) { o.height = 100000; });
  refused([](RenderOptions& o) { o.zoom = 0; });
  refused([](RenderOptions& o) { o.supersample = 9; });
  refused([](RenderOptions& o) { o.field_of_view = 180; });
}

}  // namespace
}  // namespace voxweld
