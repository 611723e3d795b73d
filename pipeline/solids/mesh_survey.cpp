#include "pipeline/solids/mesh_survey.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "pipeline/solids/closed_mesh.h"
#include "pipeline/solids/edge_parity.h"

namespace voxweld {
namespace {

// Grouping edges takes nodes of maps for their ends.
constexpr std::uint64_t bytes_of_open_edge = 512;

struct OpenEdges {
  std::uint64_t count = 0;
  std::vector<PlaceEdge> held;  // the first of them
};

MeshBoundary boundary_of_held(const std::vector<PlaceEdge>& edges) {
  std::vector<Vec3> places;
  for (const PlaceEdge& edge : edges) {
    places.push_back(edge.low);
    places.push_back(edge.high);
  }
  std::sort(places.begin(), places.end(), place_before);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const auto number = [&](Vec3 place) {
    return static_cast<std::uint32_t>(
        std::lower_bound(places.begin(), places.end(), place, place_before) - places.begin());
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> numbered;
  numbered.reserve(edges.size());
  for (const PlaceEdge& edge : edges) numbered.emplace_back(number(edge.low), number(edge.high));
  return boundary_of(numbered, places);
}

std::string first_edges_text(const std::vector<PlaceEdge>& edges) {
  std::string text = "more holes than run.memory has room for (the first edges in order of place:";
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = edges[i].low, b = edges[i].high;
    text += fmt::format("{} [{:.6g}, {:.6g}, {:.6g}] to [{:.6g}, {:.6g}, {:.6g}]",
                        i == 0 ? "" : ";", a.x, a.y, a.z, b.x, b.y, b.z);
  }
  return text + ")";
}

}  // namespace

MeshWork::Progress progress_lines(const std::filesystem::path& path) {
  using Clock = std::chrono::steady_clock;
  return [path, last = Clock::now()](std::string_view what, std::uint64_t triangles) mutable {
    if (Clock::now() - last < std::chrono::seconds(5)) return;
    last = Clock::now();
    spdlog::info("{}: {}: {:.1f} million triangles so far", path.string(), what,
                 static_cast<double>(triangles) / 1e6);
  };
}

void check_spooled_mesh(const std::filesystem::path& path, const SpooledMesh& mesh,
                        const MeshWork& work) {
  EdgeParity parity(work.folder, work.memory / 4 * 3);
  double volume = 0;
  Vec3 from;  // a corner of the mesh, so that places far from 0 cancel nothing
  bool first = true;
  std::uint64_t seen = 0;
  mesh.each(
      [&](const SpooledMesh::Corners& c) {
        if (first) from = c[0];
        first = false;
        ++seen;
        volume += dot(c[0] - from, cross(c[1] - from, c[2] - from));
        for (std::size_t i = 0; i < 3; ++i) parity.add(c[i], c[(i + 1) % 3]);
      },
      [&] { work.step("looking for holes", seen); });
  const std::size_t most = std::max<std::size_t>(work.memory / 4 / bytes_of_open_edge, 1024);
  OpenEdges open;
  parity.finish([&](const PlaceEdge& edge) {
    if (++open.count <= most) open.held.push_back(edge);
  });
  if (open.count > 0)
    refuse_open_mesh(
        path, open.count,
        open.count > most ? first_edges_text(open.held) : holes_text(boundary_of_held(open.held)),
        "close it in a mesh editor, or with close = \"winding\" where run.memory "
        "holds all of it");
  if (volume < 0)
    spdlog::warn("{}: its triangles face inward; the solid is what they enclose all the same",
                 path.string());
}

MeshSummary summary_of_mesh(const std::filesystem::path& path, std::uint64_t budget,
                            MeshClosing closing, const std::filesystem::path& folder) {
  if (closing == MeshClosing::winding || !is_mesh_name(path) || mesh_fits(path, budget, closing)) {
    const MeshFile file = read_closed_mesh(path, budget, closing);
    return {file.format, file.mesh.vertices.size(), file.mesh.triangles.size(),
            bounds_of(file.mesh)};
  }
  const MeshWork work{folder, budget - budget / 8, {}, progress_lines(path)};
  const SpooledMesh mesh(path, work);
  check_spooled_mesh(path, mesh, work);
  return {mesh.file().format, mesh.vertices(), mesh.triangles(), mesh.bounds()};
}

}  // namespace voxweld
