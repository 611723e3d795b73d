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

constexpr std::uint64_t triangle_bytes = 64;                    // at most, as it is decoded
constexpr std::uint64_t file_bytes = std::uint64_t{256} << 20;  // decoding one takes less
// However much memory there is: the report is not what a run takes most of it for.
constexpr std::uint64_t most_kept = std::uint64_t{128} << 20;

// The meshes of an output directory in their order, some of them decoded at the same time.
class Meshes {
 public:
  using Use = std::function<void(LabelledMesh&&)>;

  Meshes(const std::filesystem::path& directory, const ViewOptions& options)
      : directory_(directory), options_(options) {
    if (options.threads) at_once_ = std::clamp<std::uint64_t>(options.memory / file_bytes, 1, 4);
  }
  void each(const Use& use) const {
    std::vector<File> files;
    each_mesh_file(directory_,
                   [&](const std::filesystem::path& file, std::optional<Material> label) {
                     files.push_back({file, label});
                     if (files.size() == at_once_) take(files, use);
                   });
    take(files, use);
  }

 private:
  struct File {
    std::filesystem::path path;
    std::optional<Material> label;
  };
  void take(std::vector<File>& files, const Use& use) const {
    if (options_.interrupt != nullptr) options_.interrupt->check();
    const auto how = files.size() > 1 ? std::launch::async : std::launch::deferred;
    std::vector<std::future<DecodedMesh>> decoded;
    decoded.reserve(files.size());
    for (const File& file : files)
      decoded.push_back(std::async(how, [&] { return load_mesh(file.path); }));
    for (std::size_t i = 0; i < files.size(); ++i) use({decoded[i].get(), files[i].label});
    files.clear();
  }

  const std::filesystem::path& directory_;
  const ViewOptions& options_;
  std::uint64_t at_once_ = 1;
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
  const bool keep = options.triangles <= std::min(options.memory / 4, most_kept) / triangle_bytes;
  const Meshes meshes(directory, options);
  meshes.each([&](LabelledMesh&& one) {
    bounds.add(one.mesh);
    if (keep) kept.push_back(std::move(one));
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
    meshes.each([&](LabelledMesh&& one) {
      each_picture(options.threads, [&](std::size_t i) { renderers[i].draw(one.mesh, one.label); });
    });
  each_picture(options.threads, [&](std::size_t i) { views.pictures[i] = renderers[i].finish(); });
  return views;
}

}  // namespace voxweld
