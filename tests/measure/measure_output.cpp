// How far a mesh lies from the true surface of a phantom or from a fine mesh, how far those lie from
// it, and what is wrong with it. Of an output of voxweld's, or of a mesh file by any program.
// usage: measure_output MESH KIND SIZE | measure_output MESH --reference FINE (see --help)
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "storage/support/error.h"
#include "tests/measure/loaded_mesh.h"
#include "tests/support/mesh_defects.h"
#include "tests/support/mesh_fidelity.h"
#include "tests/support/mesh_points.h"
#include "tests/support/phantom_distance.h"

namespace voxweld {
namespace {

using namespace testing;

struct Arguments {
  std::string mesh, kind, reference;
  std::int64_t size = 0;
  std::size_t points = 200000;
  double inset = 0;
  bool no_intersections = false, json = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("MESH", arguments.mesh,
                 "An output folder of voxweld's, or a mesh in sample indices (.ply, .obj, .stl, "
                 ".off)")
      ->required();
  auto* kind =
      app.add_option("KIND", arguments.kind, "The phantom: sphere, torus, gyroid, part or temple");
  auto* size = app.add_option("SIZE", arguments.size, "Its samples along each side");
  auto* reference = app.add_option("--reference", arguments.reference,
                                   "A fine mesh, of any of these kinds, in place of a phantom");
  kind->needs(size);
  reference->excludes(kind);
  app.add_option(
         "--inset", arguments.inset,
         "Leaves out what is nearer than that to the faces of the fine mesh's box, where the "
         "samples end and methods differ by up to a sample in where the surface is")
      ->needs(reference);
  app.add_option("--points", arguments.points,
                 "Of the true surface, from which distances to the mesh are taken")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_flag("--no-intersections", arguments.no_intersections,
               "Leaves out the exact test of the triangles; the rest is faster");
  app.add_flag("--json", arguments.json, "Prints one JSON object in place of the line");
  app.footer(
      "Distances are in voxels: over the vertices, over ten points inside each triangle, over the\n"
      "same by area, and from points of the true surface to the mesh (of a fine mesh: spread over\n"
      "its area). p99: 99 of 100 are at most this. Vertices at one place are taken for one when\n"
      "defects are counted. Intersections are tested exactly, on voxweld's own lattice; those of\n"
      "other programs' meshes after rounding to 2^-10 of a sample, which may make or end some.");
}

struct Measured {
  std::size_t triangles = 0;
  MeshDistances mesh;
  DistanceStatistics surface;  // from the surface to the mesh
  std::size_t folded = 0;
  MeshDefects defects;
  std::optional<ExactDefects> exact;
  bool rounded = false;
};

// What lies within a box: its vertices, and the triangles with all three of these.
struct Inner {
  Vec3 lo, hi;

  static Inner of(const TriangleMesh& mesh, double inset) {
    Inner box{mesh.vertices.front(), mesh.vertices.front()};
    for (const Vec3& v : mesh.vertices) box = {min(box.lo, v), max(box.hi, v)};
    const Vec3 by{inset, inset, inset};
    return {box.lo + by, box.hi - by};
  }
  bool has(Vec3 p) const { return min(max(p, lo), hi) == p; }
  std::vector<Vec3> of(std::vector<Vec3> points) const {
    std::erase_if(points, [&](Vec3 p) { return !has(p); });
    return points;
  }
  std::vector<TriangleCorners> of(const TriangleMesh& mesh) const {
    std::vector<TriangleCorners> triangles = mesh.triangles;
    std::erase_if(triangles, [&](const TriangleCorners& t) {
      return std::ranges::any_of(t, [&](std::uint32_t v) { return !has(mesh.vertices[v]); });
    });
    return triangles;
  }
};

void measure_by_fine_mesh(const Arguments& arguments, const TriangleMesh& mesh, Measured& result) {
  const TriangleMesh fine = load_to_measure(arguments.reference).mesh;
  const TriangleTree tree(mesh), fine_tree(fine);
  const Inner box = Inner::of(fine, arguments.inset);
  const auto to_fine = [&](Vec3 p) { return fine_tree.distance_to(p); };
  result.mesh = measure_mesh(to_fine, mesh.vertices, box.of(mesh));
  result.mesh.vertices = measure_points(to_fine, box.of(mesh.vertices));
  result.surface = measure_points([&](Vec3 p) { return tree.distance_to(p); },
                                  box.of(points_by_area(fine, arguments.points)));
}

void measure_by_phantom(const Arguments& arguments, const TriangleMesh& mesh, Measured& result) {
  const auto field = make_analytic_field(parse_phantom_kind(arguments.kind), arguments.size);
  const TriangleTree tree(mesh);
  result.mesh = measure_mesh(*field, mesh.vertices, mesh.triangles);
  result.surface = measure_points([&](Vec3 p) { return tree.distance_to(p); },
                                  surface_points(*field, arguments.size, arguments.points));
}

Measured measure(const Arguments& arguments) {
  const LoadedMesh loaded = load_to_measure(arguments.mesh);
  Measured result;
  result.triangles = loaded.mesh.triangles.size();
  result.rounded = loaded.rounded;
  if (arguments.reference.empty())
    measure_by_phantom(arguments, loaded.mesh, result);
  else
    measure_by_fine_mesh(arguments, loaded.mesh, result);
  const TriangleMesh whole = welded(loaded.mesh);
  result.folded = folded_edges(whole);
  result.defects = find_defects(whole);
  if (!arguments.no_intersections)
    result.exact = find_exact_defects(on_lattice(loaded, whole.vertices), whole.triangles);
  return result;
}

void print_line(const Arguments& arguments, const Measured& m) {
  const std::string name = arguments.reference.empty()
                               ? fmt::format("{} {}", arguments.kind, arguments.size)
                               : arguments.reference;
  fmt::print(
      "{}: {} triangles; vertices max {:.3f} mean {:.4f} p99 {:.3f}; triangles max {:.3f} mean "
      "{:.4f} p99 {:.3f}; {} folded edges",
      name, m.triangles, m.mesh.vertices.max, m.mesh.vertices.mean, m.mesh.vertices.p99,
      m.mesh.triangles.max, m.mesh.triangles.mean, m.mesh.triangles.p99, m.folded);
  fmt::print("; triangles p99.9 {:.3f}; by area mean {:.4f} p99 {:.3f} p99.9 {:.3f}",
             m.mesh.triangles.p999, m.mesh.by_area.mean, m.mesh.by_area.p99, m.mesh.by_area.p999);
  fmt::print("; surface to mesh max {:.3f} mean {:.4f} p99 {:.3f}", m.surface.max, m.surface.mean,
             m.surface.p99);
  fmt::print("; {} boundary edges, {} non-manifold edges, {} non-manifold vertices, {} degenerate",
             m.defects.boundary_edges, m.defects.nonmanifold_edges, m.defects.nonmanifold_vertices,
             m.defects.degenerate);
  if (m.exact)
    fmt::print(", {} intersecting pairs{}", m.exact->intersecting_pairs,
               m.rounded ? fmt::format(" (rounded to 2^-10 of a sample, {} degenerate)",
                                       m.exact->degenerate)
                         : "");
  fmt::print("\n");
}

nlohmann::json to_json(const DistanceStatistics& s) {
  return {{"mean", s.mean}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}, {"count", s.count}};
}

void print_json(const Measured& m) {
  nlohmann::json defects = {{"folded_edges", m.folded},
                            {"boundary_edges", m.defects.boundary_edges},
                            {"nonmanifold_edges", m.defects.nonmanifold_edges},
                            {"nonmanifold_vertices", m.defects.nonmanifold_vertices},
                            {"degenerate_triangles", m.defects.degenerate}};
  if (m.exact) {
    defects["intersecting_pairs"] = m.exact->intersecting_pairs;
    defects["degenerate_on_lattice"] = m.exact->degenerate;
    defects["rounded_to_lattice"] = m.rounded;
  }
  const nlohmann::json result = {{"triangles", m.triangles},
                                 {"vertices_to_surface", to_json(m.mesh.vertices)},
                                 {"mesh_to_surface", to_json(m.mesh.triangles)},
                                 {"mesh_to_surface_by_area", to_json(m.mesh.by_area)},
                                 {"surface_to_mesh", to_json(m.surface)},
                                 {"defects", defects}};
  fmt::print("{}\n", result.dump());
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  CLI::App app("Distances between a mesh and the surface it stands for, and its defects");
  voxweld::Arguments arguments;
  voxweld::add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  if (arguments.kind.empty() == arguments.reference.empty()) {
    fmt::print(stderr, "measure_output: give KIND SIZE, or --reference FINE; see --help\n");
    return 2;
  }
  const voxweld::Measured measured = voxweld::measure(arguments);
  arguments.json ? voxweld::print_json(measured) : voxweld::print_line(arguments, measured);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
} catch (const std::exception& error) {
  fmt::print(stderr, "measure_output: {}\n", error.what());
  return 1;
}
