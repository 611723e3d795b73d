#include "pipeline/output/distance_colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/output/load.h"
#include "stages/refine/mesh_distance.h"
#include "storage/support/error.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

// Viridis (van der Walt and Smith, 2015), every eighth of it: dark to light, also without colours.
constexpr std::array<std::array<double, 3>, 9> scale{{{68, 1, 84},
                                                      {71, 44, 122},
                                                      {59, 81, 139},
                                                      {44, 113, 142},
                                                      {33, 144, 141},
                                                      {39, 173, 129},
                                                      {92, 200, 99},
                                                      {170, 220, 50},
                                                      {253, 231, 37}}};

// part: of the scale, 0 to 1. In linear units.
Vec3 scale_colour(double part) {
  const double at = std::clamp(part, 0.0, 1.0) * (scale.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), scale.size() - 2);
  const double rest = at - static_cast<double>(first);
  Vec3 colour;
  for (std::size_t k = 0; k < 3; ++k) {
    const double shown = (scale[first][k] * (1 - rest) + scale[first + 1][k] * rest) / 255;
    colour[static_cast<int>(k)] = shown * shown;
  }
  return colour;
}

ShownDistances summary(std::vector<float> distances) {
  std::erase_if(distances, [](float d) { return std::isnan(d); });
  ShownDistances shown;
  if (distances.empty()) return shown;
  for (const float d : distances) shown.mean += double{d};
  shown.mean /= static_cast<double>(distances.size());
  const auto p99 =
      distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) * 99 / 100);
  std::nth_element(distances.begin(), p99, distances.end());
  shown.p99 = double{*p99};
  shown.most = double{*std::max_element(p99, distances.end())};
  return shown;
}

}  // namespace

struct ReferenceMesh::Lattice {
  Vec3 origin;
  double step = 1;
  RefineMesh mesh;
  std::optional<MeshDistance> distance = {};

  LatticePoint point(const std::array<float, 3>& place) const {
    LatticePoint p{};
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = static_cast<std::int32_t>(
          std::lround((double{place[a]} - origin[static_cast<int>(a)]) / step));
    return p;
  }
};

ReferenceMesh::ReferenceMesh(const std::filesystem::path& path, const MeshBounds& drawn)
    : lattice_(std::make_unique<Lattice>()) {
  GrowingBounds own;
  for_each_mesh(path, [&](const DecodedMesh& mesh, std::optional<Material>) { own.add(mesh); });
  const Vec3 lo = min(own.bounds().lo, drawn.lo), hi = max(own.bounds().hi, drawn.hi);
  Lattice& lattice = *lattice_;
  lattice.origin = lo;
  lattice.step = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}) * 0x1p-22;
  if (!(lattice.step > 0)) lattice.step = 1;
  for_each_mesh(path, [&](const DecodedMesh& mesh, std::optional<Material>) {
    const auto first = static_cast<std::uint32_t>(lattice.mesh.positions.size());
    for (const auto& position : mesh.positions)
      lattice.mesh.positions.push_back(lattice.point(position));
    for (const auto& t : mesh.triangles)
      lattice.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  });
  if (lattice.mesh.triangles.empty())
    throw InputError(fmt::format("{}: has no triangles to measure from", path.string()));
  lattice.distance.emplace(lattice.mesh);
}

ReferenceMesh::~ReferenceMesh() = default;

ShownDistances ReferenceMesh::colour(Renderer& renderer, std::optional<double> end) const {
  const auto places = renderer.places();
  std::vector<float> distances(places.size(), std::numeric_limits<float>::quiet_NaN());
  const auto row = static_cast<std::size_t>(renderer.samples_in_a_row());
  for_each_index(places.size() / row, [&](std::size_t y) {
    MeshDistance::Hint hint;
    for (std::size_t at = y * row; at < (y + 1) * row; ++at) {
      if (std::isnan(places[at][0])) continue;
      const double squared =
          lattice_->distance->squared_beyond(lattice_->point(places[at]), 0, hint);
      distances[at] = static_cast<float>(std::sqrt(squared) * lattice_->step);
    }
  });
  ShownDistances shown = summary(distances);
  shown.end = end.value_or(shown.p99);
  renderer.recolour([&](std::size_t at) {
    return scale_colour(shown.end > 0 ? double{distances[at]} / shown.end : 0);
  });
  return shown;
}

}  // namespace voxweld
