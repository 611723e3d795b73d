// Contours a config's model, counts what comes out and draws it.
// usage: paper_figure [OPTION...] CONFIG
// Prints "polygons N triangles N", and with --parts "components N euler N defects N"; defects are
// edges and vertices that are not 2-manifold. Of several materials with --parts "components" are
// those of the materials' boundaries from the second on, added up: of what is put on or into the
// first.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "storage/support/error.h"
#include "tests/paper/drawing.h"
#include "tests/paper/model_volume.h"
#include "tests/support/mesh_check.h"

namespace {

using namespace voxweld;
using namespace voxweld::paper;

std::size_t components_of_materials(const std::vector<TileMesh>& tiles) {
  const testing::LatticeWeld welded = testing::weld_tiles(tiles);
  std::map<Material, std::vector<testing::Triangle>> boundaries;
  std::size_t next = 0;  // of the welded triangles, which keep their order
  for (const TileMesh& tile : tiles)
    for (const std::uint32_t pair : tile.triangle_pairs) {
      boundaries[tile.pairs[pair].inside].push_back(welded.triangles[next]);
      boundaries[tile.pairs[pair].outside].push_back(welded.triangles[next++]);
    }
  boundaries.erase(exterior);
  boundaries.erase(boundaries.begin());
  std::size_t components = 0;
  for (const auto& [material, triangles] : boundaries)
    components += testing::connected_components(triangles);
  return components;
}

void print_counts(const std::vector<TileMesh>& tiles, bool parts) {
  std::uint64_t polygons = 0, triangles = 0;
  for (const TileMesh& tile : tiles) {
    polygons += tile.quads + tile.polygon_triangles;
    triangles += tile.triangles.size();
  }
  fmt::print("polygons {} triangles {}", polygons, triangles);
  if (parts && !tiles.empty() && !tiles[0].pairs.empty()) {
    fmt::print(" components {}", components_of_materials(tiles));
  } else if (parts) {
    const auto summary = testing::summarize(testing::weld_tiles(tiles).triangles);
    fmt::print(" components {} euler {} defects {}", summary.components, summary.euler,
               summary.boundary_edges + summary.duplicated_edges + summary.nonmanifold_vertices);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  std::string config, png;
  std::vector<std::string> overrides;
  std::vector<double> centre;
  bool parts = false;
  Drawing drawing;
  RenderOptions& o = drawing.options;
  CLI::App app("Contours a config's model, counts what comes out and draws it");
  app.add_option("config", config)->required();
  app.add_option("--set", overrides, "table.key=value");
  app.add_option("-o,--output", png, "The PNG to write");
  app.add_flag("--parts", parts, "Counts components and what is not 2-manifold");
  app.add_option("--width", o.width, "Pixels")->capture_default_str();
  app.add_option("--height", o.height, "Pixels")->capture_default_str();
  app.add_option("--edges", drawing.edge_width, "Width of the polygons' edges; 0: none");
  app.add_option("--azimuth", o.azimuth)->capture_default_str();
  app.add_option("--elevation", o.elevation)->capture_default_str();
  app.add_option("--zoom", o.zoom)->capture_default_str();
  app.add_option("--centre", centre, "Point looked at")->expected(3);
  CLI11_PARSE(app, argc, argv);
  if (!centre.empty()) o.centre = Vec3{centre[0], centre[1], centre[2]};
  const ModelVolume model = load_model(config, overrides);
  const std::vector<TileMesh> tiles =
      contour_volume(model.volume, model.parameters, model.options()).tiles;
  if (!png.empty()) draw(tiles, drawing, png);
  print_counts(tiles, parts);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
