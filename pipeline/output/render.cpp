#include "pipeline/output/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stages/encode/label_colour.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr int max_side = 16384;
constexpr Vec3 front_colour{0.74, 0.70, 0.62}, back_colour{0.85, 0.22, 0.18};

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}
double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}
Vec3 unit(Vec3 v) {
  const double l = length(v);
  return l > 0 ? v * (1 / l) : Vec3{0, 0, 1};
}
Vec3 to_vec(const std::array<float, 3>& p) {
  return {p[0], p[1], p[2]};
}

void check(const RenderOptions& o) {
  const auto refuse = [](const char* what, auto found, const char* expected) {
    throw InputError(fmt::format("cannot render: {} is {}, expected {}", what, found, expected));
  };
  if (o.width < 1 || o.width > max_side) refuse("the width", o.width, "1 to 16384");
  if (o.height < 1 || o.height > max_side) refuse("the height", o.height, "1 to 16384");
  if (o.supersample < 1 || o.supersample > 4) refuse("supersample", o.supersample, "1 to 4");
  if (!(o.zoom > 0) || !std::isfinite(o.zoom)) refuse("the zoom", o.zoom, "a number above 0");
  if (!(o.field_of_view >= 0 && o.field_of_view <= 120))
    refuse("the field of view", o.field_of_view, "0 to 120 degrees");
  if (!std::isfinite(o.azimuth) || !std::isfinite(o.elevation))
    refuse("an angle", o.azimuth, "numbers in degrees");
}

// Light on a front-facing normal in the eye's frame (x right, y up, z to the eye), in linear units.
double light(Vec3 n) {
  constexpr Vec3 key{-0.58, 0.58, 0.57};  // upper left, towards the viewer
  const double head = std::max(0.0, n.z);
  const double soft = 0.5 + 0.5 * dot(n, key);  // wraps around: no hard terminator
  return 0.06 + 0.24 * head + 0.70 * soft * soft;
}

std::array<std::uint8_t, 3> encoded(Vec3 linear) {
  std::array<std::uint8_t, 3> out;
  for (int c = 0; c < 3; ++c)
    out[static_cast<std::size_t>(c)] =
        static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::clamp(linear[c], 0.0, 1.0))));
  return out;
}

}  // namespace

struct Renderer::Projected {
  double x = 0, y = 0;   // samples, y down
  double nearness = 0;   // grows towards the eye, linear in x and y on a plane
  bool visible = false;  // in front of the eye
};

struct Renderer::Triangle {
  std::array<Projected, 3> at;
  double area = 0;              // on the screen, twice; above 0 of what shows its back
  std::array<Vec3, 3> places;   // in the mesh's frame
  std::array<Vec3, 3> normals;  // in the eye's frame; 0 where the mesh has none
  // Where edges are asked for, the distances of corners from the edges opposite to them, on the screen.
  std::array<double, 3> heights{};
};

MeshBounds bounds_of(std::span<const DecodedMesh> meshes) {
  GrowingBounds all;
  for (const DecodedMesh& mesh : meshes) all.add(mesh);
  return all.bounds();
}

void GrowingBounds::add(const DecodedMesh& mesh) {
  for (const auto& position : mesh.positions) {
    const Vec3 p = to_vec(position);
    bounds_ = bounds_ ? MeshBounds{min(bounds_->lo, p), max(bounds_->hi, p)} : MeshBounds{p, p};
  }
}

Renderer::Renderer(const MeshBounds& bounds, const RenderOptions& options) : options_(options) {
  check(options);
  width_ = options.width * options.supersample;
  height_ = options.height * options.supersample;
  const double a = radians(options.azimuth), e = radians(options.elevation);
  back_ = {std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)};
  right_ = {std::cos(a), std::sin(a), 0};
  up_ = cross(back_, right_);
  centre_ = options.centre.value_or((bounds.lo + bounds.hi) * 0.5);
  const double radius = std::max(length(bounds.hi - bounds.lo) / 2, 1e-12);
  const double half = std::min(width_, height_) / 2.0;
  if (options.field_of_view > 0) {
    const double f = radians(options.field_of_view) / 2;
    distance_ = radius / std::sin(f);
    scale_ = half * options.zoom / std::tan(f);
  } else {
    scale_ = half * options.zoom / radius;
  }
  const auto samples = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  depth_.assign(samples, -std::numeric_limits<float>::infinity());
  colour_.resize(samples);
  if (options.places) {
    places_.assign(samples, Place{std::numeric_limits<float>::quiet_NaN(), 0, 0});
    light_.resize(samples);
  }
  for (int y = 0; y < height_; ++y) {
    const double t = static_cast<double>(y) / height_;
    const auto sky = encoded(Vec3{0.93, 0.95, 0.97} * (1 - t) + Vec3{0.78, 0.80, 0.83} * t);
    std::fill_n(colour_.begin() + static_cast<std::ptrdiff_t>(y) * width_, width_, sky);
  }
}

Renderer::Projected Renderer::project(Vec3 p) const {
  if (distance_ == 0) return {width_ / 2.0 + p.x * scale_, height_ / 2.0 - p.y * scale_, p.z, true};
  const double ahead = distance_ - p.z;
  if (!(ahead > 1e-3 * distance_)) return {};
  return {width_ / 2.0 + p.x * scale_ / ahead, height_ / 2.0 - p.y * scale_ / ahead, 1 / ahead,
          true};
}

bool Renderer::is_cut(const DecodedMesh& mesh, const std::array<std::uint32_t, 3>& triangle) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (options_.cut[a] && std::ranges::all_of(triangle, [&](std::uint32_t v) {
          return static_cast<double>(mesh.positions[v][a]) > *options_.cut[a];
        }))
      return true;
  return false;
}

// In perspective what is linear on the screen is a coordinate times the nearness.
Vec3 Renderer::place_at(const Triangle& t, const std::array<double, 3>& w) const {
  Vec3 sum{};
  double weights = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = distance_ > 0 ? w[k] * t.at[k].nearness : w[k];
    sum = sum + t.places[k] * weight;
    weights += weight;
  }
  return sum * (1 / weights);
}

bool Renderer::is_cut(Vec3 place) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (options_.cut[a] && place[static_cast<int>(a)] > *options_.cut[a]) return true;
  return false;
}

Vec3 Renderer::colour_of(Material label) const {
  const auto c = given_colour(given_, label).value_or(label_colour(label));
  return {c[0], c[1], c[2]};
}

void Renderer::draw(const DecodedMesh& mesh, std::optional<Material> label) {
  Colours colours{front_colour, back_colour};
  if (label) colours.front = colour_of(*label);
  struct Seen {
    std::uint32_t vertex = 0xffffffffu;
    Projected at;
  };
  std::vector<Seen> recent(1 << 12);  // triangles that follow each other share vertices
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[i];
    if (is_cut(mesh, corners)) continue;
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      Seen& seen = recent[corners[k] % recent.size()];
      if (seen.vertex != corners[k])
        seen = {corners[k], project(to_eye(to_vec(mesh.positions[corners[k]]) - centre_))};
      t.at[k] = seen.at;
    }
    const auto& [a, b, c] = t.at;
    if (!a.visible || !b.visible || !c.visible) continue;
    // y points down, so a counter-clockwise triangle has a negative one.
    t.area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (t.area == 0 || !std::isfinite(t.area) || (t.area > 0 && !options_.backs)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      t.places[k] = to_vec(mesh.positions[corners[k]]);
      if (!mesh.normals.empty()) t.normals[k] = to_eye(to_vec(mesh.normals[corners[k]]));
    }
    if (options_.edges) t.heights = heights_of(t);
    if (!mesh.triangle_pairs.empty())
      colours.front = colours.back = colour_of(mesh.pairs[mesh.triangle_pairs[i]].inside);
    fill(t, colours);
  }
}

std::array<double, 3> Renderer::heights_of(const Triangle& t) {
  std::array<double, 3> heights{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Projected &p = t.at[(k + 1) % 3], &q = t.at[(k + 2) % 3];
    heights[k] = std::abs(t.area) / std::max(std::hypot(q.x - p.x, q.y - p.y), 1e-12);
  }
  return heights;
}

void Renderer::fill(const Triangle& t, const Colours& colours) {
  // Samples lie in the middle of their squares.
  const auto first_at = [](double v, int size) {
    return static_cast<int>(std::clamp(std::ceil(v - 0.5), 0.0, static_cast<double>(size)));
  };
  const auto end_at = [](double v, int size) {
    return static_cast<int>(std::clamp(std::floor(v + 0.5), 0.0, static_cast<double>(size)));
  };
  const auto& [a, b, c] = t.at;
  const auto [x_lo, x_hi] = std::minmax({a.x, b.x, c.x});
  const auto [y_lo, y_hi] = std::minmax({a.y, b.y, c.y});
  const int x0 = first_at(x_lo, width_), x1 = end_at(x_hi, width_);
  const int y0 = first_at(y_lo, height_), y1 = end_at(y_hi, height_);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      std::array<double, 3> w;  // barycentric on the screen, times the area
      bool outside = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Projected &p = t.at[(k + 1) % 3], &q = t.at[(k + 2) % 3];
        w[k] = (q.x - p.x) * (py - p.y) - (q.y - p.y) * (px - p.x);
        outside |= t.area > 0 ? w[k] < 0 : w[k] > 0;
      }
      if (outside) continue;
      for (double& weight : w) weight /= t.area;
      fill_sample(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(x),
                  t, w, colours);
    }
  }
}

// What is not asked for is not computed: most triangles have no sample or one.
void Renderer::fill_sample(std::size_t at, const Triangle& t, const std::array<double, 3>& w,
                           const Colours& colours) {
  const auto nearness = static_cast<float>(w[0] * t.at[0].nearness + w[1] * t.at[1].nearness +
                                           w[2] * t.at[2].nearness);
  if (!(nearness > depth_[at])) return;
  const bool cuts = std::ranges::any_of(options_.cut, [](const auto& cut) { return bool{cut}; });
  const Vec3 place = cuts || options_.places ? place_at(t, w) : Vec3{};
  if (cuts && is_cut(place)) return;
  depth_[at] = nearness;
  const bool back = t.area > 0;
  Vec3 n = normal_at(t, w);
  if (back) n = n * -1;
  const double shade = options_.edges ? edge_shade(w, t.heights) : 1;
  const double lit = light(n) * shade;
  colour_[at] = encoded((back ? colours.back : colours.front) * lit);
  if (!options_.places) return;
  for (std::size_t a = 0; a < 3; ++a)
    places_[at][a] = static_cast<float>(place[static_cast<int>(a)]);
  light_[at] = static_cast<float>(lit);
}

Vec3 Renderer::normal_at(const Triangle& t, const std::array<double, 3>& w) const {
  if (dot(t.normals[0], t.normals[0]) > 0)
    return unit(t.normals[0] * w[0] + t.normals[1] * w[1] + t.normals[2] * w[2]);
  const auto position = [&](std::size_t k) { return to_eye(t.places[k] - centre_); };
  return unit(cross(position(1) - position(0), position(2) - position(0)));
}

double Renderer::edge_shade(const std::array<double, 3>& w,
                            const std::array<double, 3>& heights) const {
  const double away = std::min({w[0] * heights[0], w[1] * heights[1], w[2] * heights[2]});
  // Half a line lies on each side of an edge.
  return away < 0.5 * options_.supersample ? 0.12 : 1;
}

void Renderer::recolour(const std::function<Vec3(std::size_t)>& f) {
  for (std::size_t at = 0; at < places_.size(); ++at)
    if (!std::isnan(places_[at][0]))
      colour_[at] = encoded(f(at) * (0.35 + 0.65 * double{light_[at]}));
}

Image Renderer::finish() const {
  Image image{options_.width, options_.height, {}};
  const int s = options_.supersample;
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.rgb.reserve(3 * pixels);
  if (options_.transparent) image.alpha.reserve(pixels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<int, 3> sum{};
      int covered = 0;  // samples that count
      for (int i = 0; i < s * s; ++i) {
        const std::size_t at =
            static_cast<std::size_t>(y * s + i / s) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(x * s + i % s);
        if (options_.transparent && std::isinf(depth_[at])) continue;
        ++covered;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += colour_[at][k];
      }
      for (const int v : sum)
        image.rgb.push_back(
            static_cast<std::uint8_t>(covered > 0 ? (v + covered / 2) / covered : 0));
      if (options_.transparent)
        image.alpha.push_back(static_cast<std::uint8_t>((255 * covered + s * s / 2) / (s * s)));
    }
  }
  return image;
}

}  // namespace voxweld
