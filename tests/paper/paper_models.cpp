// Writes stand-ins for the models of Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite
// Data", 2002, as configs of exact solids.
// usage: paper_models [OPTION...] FOLDER
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/paper/models.h"

int main(int argc, char** argv) try {
  using namespace voxweld;
  using namespace voxweld::paper;
  std::filesystem::path folder, font;
  std::int64_t part = 64, temple = 256, cube = 128;
  std::vector<std::tuple<std::string, std::filesystem::path, std::int64_t>> meshes;
  CLI::App app("Writes stand-ins for the paper's models as configs");
  app.add_option("folder", folder)->required();
  app.add_option("--part", part, "Cells a side")->capture_default_str();
  app.add_option("--temple", temple, "Cells a side")->capture_default_str();
  app.add_option("--cube", cube, "Cells a side")->capture_default_str();
  app.add_option("--font", font, "Of the cube's characters; without one there is no cube");
  app.add_option("--mesh", meshes, "NAME FILE CELLS: a config of a closed mesh");
  CLI11_PARSE(app, argc, argv);
  make_directories(folder);
  write_part({folder, part});
  write_temple({{folder, temple}, "temple", false, false});
  write_temple({{folder, temple}, "temple_turned", true, false});
  write_temple({{folder, temple}, "temple_round", false, true});
  for (const auto& [name, mesh, cells] : meshes) write_mesh_model({{folder, cells}, name, mesh});
  // The sides in the order +x, -x, +y, -y, +z, -z; the paper's name and its subject's.
  if (!font.empty()) write_cube({{folder, cube}, font, {U'双', U'等', U'值', U'线', U'面', U'体'}});
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
