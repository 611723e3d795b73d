#include "pipeline/report/mesh_views.h"

#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/output/load.h"

namespace voxweld {
namespace {

struct LabelledMesh {
  DecodedMesh mesh;
  std::optional<Material> label;
};

void extend(MeshBounds& bounds, const DecodedMesh& mesh) {
  if (mesh.positions.empty()) return;
  const MeshBounds own = bounds_of(std::span(&mesh, 1));
  bounds.lo = min(bounds.lo, own.lo);
  bounds.hi = max(bounds.hi, own.hi);
}

// f(i) of each picture.
void each_picture(bool threads, const std::function<void(std::size_t)>& f) {
  std::vector<std::future<void>> under_way;
  for (std::size_t i = 0; i < view_azimuths.size(); ++i)
    if (threads)
      under_way.push_back(std::async(std::launch::async, f, i));
    else
      f(i);
  for (std::future<void>& one : under_way) one.get();
}

}  // namespace

MeshViews draw_views(const std::filesystem::path& directory, const ViewOptions& options) {
  constexpr double far = std::numeric_limits<double>::infinity();
  MeshViews views{{{far, far, far}, {-far, -far, -far}}, {}};
  std::vector<LabelledMesh> kept;
  const bool keep = options.triangles <= options.most_kept;
  const auto check = [&] {
    if (options.interrupt != nullptr) options.interrupt->check();
  };
  for_each_mesh(directory, [&](const DecodedMesh& mesh, std::optional<Material> label) {
    check();
    extend(views.bounds, mesh);
    if (keep) kept.push_back({mesh, label});
  });
  if (!(views.bounds.lo.x <= views.bounds.hi.x)) views.bounds = {};
  const MaterialTable colours = listed_colours(directory);
  std::vector<Renderer> renderers;
  for (const double azimuth : view_azimuths) {
    RenderOptions view;
    view.width = options.width;
    view.height = options.height;
    view.supersample = options.supersample;
    view.azimuth = azimuth;
    view.elevation = view_elevation;
    renderers.emplace_back(views.bounds, view).set_colours(colours);
  }
  const auto draw = [&](const DecodedMesh& mesh, std::optional<Material> label) {
    check();
    each_picture(options.threads, [&](std::size_t i) { renderers[i].draw(mesh, label); });
  };
  if (keep)
    each_picture(options.threads, [&](std::size_t i) {
      for (const LabelledMesh& one : kept) renderers[i].draw(one.mesh, one.label);
    });
  else
    for_each_mesh(directory, draw);
  each_picture(options.threads, [&](std::size_t i) { views.pictures[i] = renderers[i].finish(); });
  return views;
}

}  // namespace voxweld
