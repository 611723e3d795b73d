// Pictures of meshes, by a z-buffer in software: the same bytes on every machine, from any number
// of tiles, each needed only while it is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "storage/types/box.h"
#include "storage/types/material_table.h"

namespace voxweld {

struct RenderOptions {
  int width = 1200, height = 900;
  double azimuth = 30, elevation = 25;  // degrees: where the eye is; z is up, 0 looks along +y
  double zoom = 1;                      // 1: the whole mesh fits
  std::optional<Vec3> centre = std::nullopt;  // looked at; the middle of the bounds by default
  double field_of_view = 30;                  // degrees, of the height; 0: orthographic
  int supersample = 2;                        // samples a side of a pixel, 1 to 4
  bool backs = true;  // false: not drawn, as of a closed mesh that hides them anyway
  // Only what lies at or below this on an axis is drawn: to look inside.
  std::array<std::optional<double>, 3> cut = {};
  bool edges = false;        // of triangles, as dark lines about a pixel wide
  bool transparent = false;  // where there is no mesh, in place of a sky
  bool places = false;       // kept for each sample, for Renderer::recolour
};

// RGB, 8 bits each, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> alpha = {};  // one a pixel, or empty: all is opaque
};

struct MeshBounds {
  Vec3 lo, hi;
};
MeshBounds bounds_of(std::span<const DecodedMesh> meshes);

// Of meshes that are in memory one after the other.
class GrowingBounds {
 public:
  void add(const DecodedMesh& mesh);
  MeshBounds bounds() const { return bounds_.value_or(MeshBounds{}); }

 private:
  std::optional<MeshBounds> bounds_;
};

// A picture in the making: for each sample depth and colour, 7 bytes times width, height and
// supersample squared. InputError for a size, sample count or zoom out of range.
// Fronts are warm grey, lit from the eye and from the upper left; backs are red, so that an
// inside-out piece, or the inside seen through a crack, shows. Between labels both sides have the
// colour of the label the triangle encloses, and fronts of a label's own mesh have that label's:
// the one it is given, else label_colour. Normals of the mesh are used where it has them, else each
// triangle's own.
class Renderer {
 public:
  Renderer(const MeshBounds& bounds, const RenderOptions& options);
  void set_colours(MaterialTable given) { given_ = std::move(given); }
  void draw(const DecodedMesh& mesh, std::optional<Material> label = {});
  // Where on the mesh each sample lies; of rows from the top, not a number where nothing was drawn.
  // 16 bytes more a sample. Precondition here and below: RenderOptions::places.
  using Place = std::array<float, 3>;
  std::span<const Place> places() const { return places_; }
  int samples_in_a_row() const { return width_; }
  // Colours what was drawn anew: f(sample) is linear RGB from 0 to 1. Edges stay, and light,
  // but softer: dark colours have to be told apart.
  void recolour(const std::function<Vec3(std::size_t)>& f);
  Image finish() const;

 private:
  struct Projected;
  struct Triangle;
  Vec3 to_eye(Vec3 v) const { return {dot(v, right_), dot(v, up_), dot(v, back_)}; }
  Projected project(Vec3 position) const;  // in the eye's frame
  struct Colours {
    Vec3 front, back;
  };
  Vec3 colour_of(Material label) const;
  // The place at one sample of a triangle, by its weights, barycentric on the screen.
  Vec3 place_at(const Triangle& triangle, const std::array<double, 3>& weights) const;
  Vec3 normal_at(const Triangle& triangle, const std::array<double, 3>& weights) const;
  // Whether all of a triangle is, or a place.
  bool is_cut(const DecodedMesh& mesh, const std::array<std::uint32_t, 3>& triangle) const;
  bool is_cut(Vec3 place) const;
  void fill(const Triangle& triangle, const Colours& colours);
  void fill_sample(std::size_t at, const Triangle& triangle, const std::array<double, 3>& weights,
                   const Colours& colours);
  static std::array<double, 3> heights_of(const Triangle& triangle);
  // How much of its light a sample keeps, by the distance to the nearest edge.
  double edge_shade(const std::array<double, 3>& weights,
                    const std::array<double, 3>& heights) const;

  RenderOptions options_;
  MaterialTable given_;
  Vec3 centre_, right_, up_, back_;  // of the eye's frame; back_ points at the eye
  double scale_ = 1, distance_ = 0;
  int width_ = 0, height_ = 0;  // in samples
  std::vector<float> depth_;
  std::vector<std::array<std::uint8_t, 3>> colour_;
  std::vector<Place> places_;  // and how much light there is; both empty unless asked for
  std::vector<float> light_;
};

}  // namespace voxweld
