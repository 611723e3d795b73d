#include "stages/refine/vertex_normals.h"

#include <algorithm>
#include <cmath>

#include "stages/contouring/normal_clusters.h"

namespace voxweld {
namespace {

constexpr double cells_of_volume = 16;  // how much area the volume's normal weighs

struct Face {
  Vec3 area;  // along its normal
  double size = 0;
};

double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}

// Directions of a vertex, each the sum of what it was made of.
class Directions {
 public:
  Directions(const std::array<PackedNormal, max_clusters>& packed, double weight, NormalSense sense,
             const NormalRule& rule)
      : either_(sense == NormalSense::either), rule_(rule) {
    for (const PackedNormal one : packed)
      if (one != no_normal) sums_[count_++] = unpack_normal(one) * weight;
  }

  // To the nearest where one is near enough; else it is one more, or takes the place of the least.
  void add(const Face& face) {
    std::size_t best = 0, least = 0;
    double likeness = -2, sign = 1;
    for (std::size_t k = 0; k < count_; ++k) {
      const double size = length(sums_[k]);
      const double cosine = dot(sums_[k], face.area) / (size * face.size);
      const double turn = either_ && cosine < 0 ? -1 : 1;
      if (turn * cosine > likeness) {
        likeness = turn * cosine;
        sign = turn;
        best = k;
      }
      if (size < length(sums_[least])) least = k;
    }
    if (likeness >= double{rule_.own_cosine})
      sums_[best] = sums_[best] + face.area * sign;
    else
      add_own(face, least);
  }

  std::array<PackedNormal, max_clusters> packed() const {
    std::array<PackedNormal, max_clusters> out;
    out.fill(no_normal);
    std::size_t count = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double size = length(sums_[k]);  // opposite ones may cancel
      if (size > 0) out[count++] = pack_normal(sums_[k] * (1 / size));
    }
    return out;
  }

 private:
  void add_own(const Face& face, std::size_t least) {
    if (count_ < max_clusters)
      sums_[count_++] = face.area;
    else if (length(sums_[least]) < face.size)
      sums_[least] = face.area;
  }

  std::array<Vec3, max_clusters> sums_{};
  std::size_t count_ = 0;
  bool either_;
  NormalRule rule_;
};

}  // namespace

void settle_normals(EditMesh& mesh, double cell, const NormalRule& rule) {
  std::vector<Face> faces;
  for (std::uint32_t v = 0; v < mesh.vertices(); ++v) {
    const auto* packed = mesh.normals(v);
    if (packed == nullptr || mesh.gone(v) || mesh.freedom(v) != Freedom::free) continue;
    faces.clear();
    mesh.each_around(v, [&](std::uint32_t t) {
      const Vec3 area = as_vec3(mesh.normal(t)) * 0.5;
      faces.push_back({area, length(area)});
    });
    // The largest first; triangles come by their numbers, which are those of their ids.
    std::stable_sort(faces.begin(), faces.end(),
                     [](const Face& a, const Face& b) { return a.size > b.size; });
    Directions directions(*packed, cells_of_volume * cell * cell, mesh.sense(), rule);
    for (const Face& face : faces)
      if (face.size > 0) directions.add(face);
    mesh.set_normals(v, directions.packed());
  }
}

}  // namespace voxweld
