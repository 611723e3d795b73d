// One row of the paper's table: polygons, time and space of a config's model.
// usage: paper_table [OPTION...] CONFIG
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "storage/support/error.h"
#include "tests/paper/staged_contour.h"
#include "tests/paper/stopwatch.h"
#include "tests/support/allocation_count.h"

namespace {

using namespace voxweld;
using namespace voxweld::paper;

struct Arguments {
  std::string config, name, grid;
  std::vector<std::string> overrides;
  std::vector<double> paper;  // quads, milliseconds, megabytes
  int turns = 7;
};

struct Row {
  std::uint64_t polygons = 0;
  double generate_ms = 0, whole_ms = 0;  // medians
  // Bytes: of the whole tree at once; the most that build holds beyond the samples; of what it
  // leaves.
  std::uint64_t at_once = 0, peak = 0, finished = 0;
};

// From the signed octree with its Hermite data on, as the paper measures; and what the octree of
// the whole volume takes at once, as the paper keeps it: signs, Hermite data, all nodes with QEFs.
void measure_paper(const ModelVolume& model, int turns, Row& row) {
  const std::uint64_t before = testing::live_bytes();
  const std::vector<HermiteBrick> hermite = hermite_data(model, Homogeneous::forget);
  row.at_once = testing::live_bytes() - before;
  VolumeBricks bricks;
  std::uint64_t node_bytes = 0;
  row.generate_ms = median(turns, [&] {
    return processor_ms([&] {
      bricks = no_bricks(model);
      Simplifier simplifier(model);
      for (const HermiteBrick& brick : hermite)
        simplifier.simplify(brick, bricks.octrees[morton_encode(brick.at)]);
      contour_bricks(bricks);
      node_bytes = simplifier.node_bytes();
    });
  });
  row.at_once += node_bytes;
  const std::string differs = difference(bricks, build_bricks(model));
  if (!differs.empty())
    throw std::logic_error("what is measured is not what build_brick does: " + differs);
}

// As the program does: brick by brick, from the samples.
void measure_program(const ModelVolume& model, int turns, Row& row) {
  row.whole_ms =
      median(turns, [&] { return processor_ms([&] { contour_bricks(build_bricks(model)); }); });
  const std::uint64_t before = testing::live_bytes();
  testing::forget_peak();
  const VolumeBricks bricks = build_bricks(model);
  row.peak = testing::peak_bytes() - before;
  row.finished = testing::live_bytes() - before;
  for (const TileMesh& tile : contour_bricks(bricks).tiles) {
    row.polygons += tile.quads + tile.polygon_triangles;
  }
}

std::string verdict(double ours, double theirs) {
  return fmt::format("{:.3f} | {}", ours / theirs, ours < 0.1 * theirs ? "yes" : "no");
}

void print(const Arguments& arguments, const Row& row) {
  const double quads = arguments.paper[0], ms = arguments.paper[1], mb = arguments.paper[2];
  const auto polygons = static_cast<double>(row.polygons);
  fmt::print("time: | {} | {} | {:g} | {} | {:g} | {:.1f} | {} | {:.1f} | {:.1f} | {:.1f} |\n",
             arguments.name, arguments.grid, quads, row.polygons, ms, row.generate_ms,
             verdict(row.generate_ms, ms), 1e3 * ms / quads, 1e3 * row.generate_ms / polygons,
             row.whole_ms);
  const auto megabytes = [](std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; };
  fmt::print("space: | {} | {} | {:g} | {:.2f} | {} | {:.2f} | {} | {:.2f} |\n", arguments.name,
             arguments.grid, mb, megabytes(row.at_once), verdict(megabytes(row.at_once), mb),
             megabytes(row.peak), verdict(megabytes(row.peak), mb), megabytes(row.finished));
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments arguments;
  CLI::App app("One row of the paper's table, of the model a config describes");
  app.add_option("config", arguments.config)->required();
  app.add_option("--name", arguments.name)->required();
  app.add_option("--grid", arguments.grid)->required();
  app.add_option("--paper", arguments.paper, "Quads, ms and MB")->expected(3)->required();
  app.add_option("--set", arguments.overrides, "table.key=value");
  app.add_option("--turns", arguments.turns)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const ModelVolume model = load_model(arguments.config, arguments.overrides);
  Row row;
  measure_paper(model, arguments.turns, row);
  measure_program(model, arguments.turns, row);
  print(arguments, row);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
