// Counts the intersecting pairs of an output's triangles with CGAL's exact predicates: another way
// than voxweld's own, to compare with.
// Usage: cgal_intersections OUTPUT_DIRECTORY
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <array>
#include <exception>
#include <iterator>
#include <map>
#include <vector>

#include "pipeline/output/load.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    fmt::print(stderr, "usage: cgal_intersections OUTPUT_DIRECTORY\n");
    return 2;
  }
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  std::map<std::array<float, 3>, std::size_t> numbers;
  voxweld::for_each_mesh(argv[1], [&](const voxweld::DecodedMesh& mesh, auto) {
    for (const auto& t : mesh.triangles) {
      std::array<std::size_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<float, 3>& p = mesh.positions[t[k]];
        const auto [at, is_new] = numbers.try_emplace(p, points.size());
        if (is_new) points.emplace_back(p[0], p[1], p[2]);
        triangle[k] = at->second;
      }
      triangles.push_back(triangle);
    }
  });
  namespace pmp = CGAL::Polygon_mesh_processing;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  if (!pmp::is_polygon_soup_a_polygon_mesh(triangles)) {
    fmt::print(stderr, "{}: no 2-manifold, which this way of CGAL needs\n", argv[1]);
    return 1;
  }
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  pmp::self_intersections(mesh, std::back_inserter(pairs));
  fmt::print("{} triangles, {} intersecting pairs\n", triangles.size(), pairs.size());
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "cgal_intersections: {}\n", error.what());
  return 1;
}
