#include "stages/refine/vertex_places.h"

#include <algorithm>
#include <cmath>

#include "stages/refine/edit_moves.h"
#include "storage/types/brick_octree.h"

namespace voxweld {
namespace {

constexpr int rounds = 2;  // a vertex may have to make room for another
// Cosines between a triangle's normal and the nearest of a vertex', the worst of its three: what no
// triangle comes to that was better before, and up to where its edges may be flipped. On smooth
// surfaces normals say less than stitch knew when it cut its quads.
constexpr double least_agreement = 0.3;
constexpr double poor_agreement = 0.85;
constexpr double least_gain = 0.01;  // of a flip, in squared cells
// A move may lose so much: what is around a vertex may be as far from its place, and go there later. With
// none at all the worst vertices at creases stay; with any at all there are more triangles where normals
// are noise.
constexpr double most_loss = 0.05;

class Placer {
 public:
  Placer(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh),
        tolerance_(parameters.places.value_or(parameters.tolerance)),
        least_gain_(least_gain * parameters.reach * parameters.reach),
        most_loss_(most_loss * parameters.reach * parameters.reach),
        counts_(counts),
        moves_(mesh),
        fine_(mesh.triangles()) {
    first_direction_.reserve(mesh.vertices() + 1);
    directions_.reserve(mesh.vertices());
    for (std::uint32_t v = 0; v < mesh.vertices(); ++v) {
      first_direction_.push_back(static_cast<std::uint32_t>(directions_.size()));
      for (const PackedNormal packed : *mesh.normals(v))
        if (packed != no_normal) directions_.push_back(unpack_normal(packed));
    }
    first_direction_.push_back(static_cast<std::uint32_t>(directions_.size()));
  }

  void run() {
    for (int round = 0; round < rounds; ++round) {
      for (std::uint32_t v = 0; v < mesh_.vertices(); ++v) move(v);
      for (std::uint32_t t = 0; t < mesh_.triangles(); ++t) flip(t);
    }
  }

 private:
  // How well a triangle agrees with the normals of its vertices.
  struct Agreement {
    double cosine = 1;
    double area = 0;  // twice that
    double loss() const { return (1 - cosine) * area; }
  };
  Agreement agreement(const Corners& corners, const Index3& plane) const;
  Agreement agreement(std::uint32_t t) const {
    return agreement(mesh_.corners(t), mesh_.normal(t));
  }
  bool is_better(const Change& change, double least) const;
  bool apply(const EditMesh::Step& step, double least);
  void move(std::uint32_t v);
  void flip(std::uint32_t t);

  EditMesh& mesh_;
  double tolerance_, least_gain_, most_loss_;
  RefineCounts& counts_;
  EditMoves moves_;
  Change change_;
  // Of vertices their normals, of v those from first_direction_[v] on and before that of v + 1.
  std::vector<Vec3> directions_;
  std::vector<std::uint32_t> first_direction_;
  std::vector<std::uint8_t> fine_;  // triangles that need no flip, or have none, as all is now
};

Placer::Agreement Placer::agreement(const Corners& corners, const Index3& plane) const {
  const Vec3 n = as_vec3(plane);
  Agreement agreement{1, std::sqrt(dot(n, n))};
  for (const std::uint32_t v : corners) {
    const std::uint32_t begin = first_direction_[v], end = first_direction_[v + 1];
    if (begin == end) continue;
    double best = -2 * agreement.area;
    for (std::uint32_t i = begin; i < end; ++i) {
      const double cosine = dot(directions_[i], n);
      best = std::max(best, mesh_.sense() == NormalSense::either ? std::abs(cosine) : cosine);
    }
    agreement.cosine = std::min(agreement.cosine, best / agreement.area);
  }
  return agreement;
}

bool Placer::is_better(const Change& change, double least) const {
  double gain = 0;
  for (std::size_t i = 0; i < change.now.size(); ++i) {
    const Agreement now = agreement(change.now[i], change.planes[i]);
    const Agreement before = agreement(change.old[i]);
    if (now.cosine < least_agreement && now.cosine < before.cosine) return false;
    gain += before.loss() - now.loss();
  }
  return gain >= least;
}

bool Placer::apply(const EditMesh::Step& step, double least) {
  if (!is_better(change_, least) || !mesh_.keeps_samples(change_, step, tolerance_) ||
      !mesh_.clean(change_))
    return false;
  mesh_.apply(change_, step);
  // What was said of triangles beside these holds no more.
  for (const Corners& corners : change_.now)
    for (const std::uint32_t v : corners)
      mesh_.each_around(v, [&](std::uint32_t t) { fine_[t] = 0; });
  return true;
}

void Placer::move(std::uint32_t v) {
  const LatticePoint from = mesh_.position(v), aim = mesh_.aim(v);
  if (aim == from || mesh_.freedom(v) != Freedom::free) return;
  for (const std::int32_t quarters : {4, 3, 2, 1}) {
    LatticePoint at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = from[a] + (aim[a] - from[a]) * quarters / 4;
    if (at == from || !mesh_.box().contains(at) || !mesh_.keeps_border(v, at)) continue;
    if (!moves_.move(v, at, change_)) continue;
    // The place that it leaves was none of the surface.
    if (!apply({v, at, EditMesh::none, false}, -most_loss_)) continue;
    ++counts_.moves;
    return;
  }
}

void Placer::flip(std::uint32_t t) {
  if (!mesh_.movable(t) || fine_[t] != 0) return;
  // It is the worse one of the two, or the other one's turn.
  const Agreement now = agreement(t);
  if (now.cosine > poor_agreement || now.loss() < least_gain_ / 2) {
    fine_[t] = 1;
    return;
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (moves_.flip(t, k, change_) && apply({}, least_gain_)) {
      ++counts_.flips;
      return;
    }
  fine_[t] = 1;
}

}  // namespace

void settle_places(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts) {
  if (!mesh.has_normals()) return;
  Placer(mesh, parameters, counts).run();
  mesh.recheck_intersecting();
}

}  // namespace voxweld
