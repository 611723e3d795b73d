#include "pipeline/report/mesh_views.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/output/load.h"

namespace voxweld {
namespace {

struct LabelledMesh {
  DecodedMesh mesh;
  std::optional<Material> label;
};

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

// What it takes to let the box of the mesh fill nine tenths of the picture, as Renderer puts its
// corners there.
double fitting_zoom(const MeshBounds& bounds, const RenderOptions& view) {
  constexpr double filled = 0.9, radians = std::numbers::pi / 180;
  const double a = view.azimuth * radians, e = view.elevation * radians;
  const Vec3 back{std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)};
  const Vec3 right{std::cos(a), std::sin(a), 0}, up = cross(back, right);
  const Vec3 half = (bounds.hi - bounds.lo) * 0.5;
  const double radius = std::sqrt(dot(half, half)), f = view.field_of_view * radians / 2;
  double zoom = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 d = half;
    for (int axis = 0; axis < 3; ++axis)
      if ((corner >> axis & 1) != 0) d[axis] = -d[axis];
    // Of the picture's smaller side, at a zoom of 1.
    const double ahead = (radius / std::sin(f) - dot(d, back)) * std::tan(f);
    const double smaller = std::min(view.width, view.height);
    for (const auto& [offset, side] :
         {std::pair{dot(d, right), view.width}, std::pair{dot(d, up), view.height}})
      if (offset != 0) zoom = std::min(zoom, filled * side / smaller * ahead / std::abs(offset));
  }
  return std::isfinite(zoom) ? zoom : 1;
}

}  // namespace

MeshViews draw_views(const std::filesystem::path& directory, const ViewOptions& options) {
  MeshViews views;
  GrowingBounds bounds;
  std::vector<LabelledMesh> kept;
  const bool keep = options.triangles <= options.most_kept;
  each_mesh_file(directory, [&](const std::filesystem::path& file, std::optional<Material> label) {
    if (options.interrupt != nullptr) options.interrupt->check();
    DecodedMesh mesh = load_mesh(file);
    bounds.add(mesh);
    if (keep) kept.push_back({std::move(mesh), label});
  });
  views.bounds = bounds.bounds();
  const MaterialTable colours = listed_colours(directory);
  std::vector<Renderer> renderers;
  for (const double azimuth : view_azimuths) {
    RenderOptions view;
    view.width = options.width;
    view.height = options.height;
    view.supersample = options.supersample;
    view.azimuth = azimuth;
    view.elevation = view_elevation;
    view.backs = !options.closed;
    view.zoom = fitting_zoom(views.bounds, view);
    renderers.emplace_back(views.bounds, view).set_colours(colours);
  }
  if (keep)
    each_picture(options.threads, [&](std::size_t i) {
      for (const LabelledMesh& one : kept) renderers[i].draw(one.mesh, one.label);
    });
  else
    for_each_mesh(directory, [&](const DecodedMesh& mesh, std::optional<Material> label) {
      if (options.interrupt != nullptr) options.interrupt->check();
      each_picture(options.threads, [&](std::size_t i) { renderers[i].draw(mesh, label); });
    });
  each_picture(options.threads, [&](std::size_t i) { views.pictures[i] = renderers[i].finish(); });
  return views;
}

}  // namespace voxweld
