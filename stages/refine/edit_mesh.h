// A mesh that is being changed in one cube: who its neighbours are, what may move, what stands where.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/contouring/normal_clusters.h"
#include "stages/exact/orientation.h"
#include "stages/exact/triangle_pair.h"
#include "stages/refine/nearest_triangle.h"
#include "stages/refine/triangle_grid.h"
#include "stages/refine/umbrella.h"
#include "stages/refine/vertex_star.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// What may be done with a vertex.
enum class Freedom : std::uint8_t {
  fixed,   // nothing
  anchor,  // others may come to it: its star is whole, but not all of it lies in the cube
  free,    // its star lies in the cube: it may move, and go where its kind allows
};

using Corners = std::array<std::uint32_t, 3>;
inline bool uses(const Corners& c, std::uint32_t v) {
  return c[0] == v || c[1] == v || c[2] == v;
}
// Which corner v is. Precondition: it is one.
inline std::size_t corner_of(const Corners& c, std::uint32_t v) {
  return c[0] == v ? 0 : c[1] == v ? 1 : 2;
}

// Triangles in place of others.
struct Change {
  static constexpr std::size_t most = 64;  // that are new

  std::vector<std::uint32_t> old;  // numbers
  std::vector<Corners> now;
  std::vector<LatticeTriangle> shapes;  // of `now`, and their exact normals
  std::vector<Index3> planes;

  void clear() {
    old.clear();
    now.clear();
    shapes.clear();
    planes.clear();
  }
};

class EditMesh {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  // Vertices are numbered by their ids, triangles by their vertices, whatever the order in `mesh`.
  // samples: RefineParameters'.
  EditMesh(const RefineMesh& mesh, const LatticeBox& box,
           const std::optional<LatticeBox>& samples = {});
  RefineMesh take() &&;

  const LatticeBox& box() const { return box_; }
  std::uint32_t vertices() const { return static_cast<std::uint32_t>(positions_.size()); }
  std::uint32_t triangles() const { return static_cast<std::uint32_t>(triangles_.size()); }
  VertexId id(std::uint32_t v) const { return ids_[v]; }
  const LatticePoint& position(std::uint32_t v) const { return positions_[v]; }
  // Where it would best lie: its position where nothing is known.
  const LatticePoint& aim(std::uint32_t v) const {
    return aims_.empty() ? positions_[v] : aims_[v];
  }
  Freedom freedom(std::uint32_t v) const { return freedom_[v]; }
  // Precondition: it is not fixed. No change that is made here changes it.
  StarKind kind(std::uint32_t v) const { return kinds_[v]; }
  // No vertex of a rim goes further into the volume than it is, so that all know where the mesh may end.
  bool keeps_border(std::uint32_t v, const LatticePoint& to) const {
    return kinds_[v] != StarKind::rim || depth(to) <= std::max(0, depth(positions_[v]));
  }
  bool may_go(std::uint32_t v) const {
    return freedom_[v] == Freedom::free && kinds_[v] != StarKind::point;
  }
  const Corners& corners(std::uint32_t t) const { return triangles_[t]; }
  bool alive(std::uint32_t t) const { return triangles_[t][0] != none; }
  // All of its corners lie in the cube.
  bool movable(std::uint32_t t) const { return movable_[t] != 0; }
  // What the triangle separates; of a mesh without labels the same for all.
  MaterialPair sides(std::uint32_t t) const { return sides_.empty() ? MaterialPair{} : sides_[t]; }
  LatticeTriangle shape(std::uint32_t t) const { return shape(triangles_[t]); }
  LatticeTriangle shape(const Corners& c) const {
    return {positions_[c[0]], positions_[c[1]], positions_[c[2]]};
  }
  const Index3& normal(std::uint32_t t) const { return planes_[t]; }  // exact_normal of its shape
  // Where labels meet, normals have no outside.
  NormalSense sense() const { return sides_.empty() ? NormalSense::outward : NormalSense::either; }
  // Grows whenever it moves, takes in another, or goes.
  std::uint32_t version(std::uint32_t v) const { return versions_[v]; }
  bool gone(std::uint32_t v) const { return heads_[v] == none; }

  // f(triangle) of each that uses the vertex.
  template <class F>
  void each_around(std::uint32_t v, F&& f) const {
    for (std::uint32_t c = heads_[v]; c != none; c = next_[c]) f(c / 3);
  }
  void star(std::uint32_t v, std::vector<std::uint32_t>& out) const {
    each_around(v, [&](std::uint32_t t) { out.push_back(t); });
  }

  // How many triangles use both.
  std::size_t around_edge(std::uint32_t u, std::uint32_t v) const {
    std::size_t count = 0;
    each_around(u, [&](std::uint32_t t) { count += uses(triangles_[t], v) ? 1 : 0; });
    return count;
  }

  // Whether the shapes of `change` intersect nothing, neither each other nor what stays.
  bool clean(const Change& change);
  // The same of those that share a vertex with a new one.
  bool clean_around(const Change& change);
  // Intersections that they have; stops counting at `most`. likely: triangles that stay, to be looked
  // at first, each once.
  std::size_t hits(const Change& change, std::size_t most,
                   std::span<const std::uint32_t> likely = {});
  // f(other) for each triangle that intersects t.
  template <class F>
  void each_hit(std::uint32_t t, F&& f) {
    each_hit_if(
        t, [&](std::uint32_t other) { return hit(t, other); }, f);
  }
  // The same where it is intersects(other) that says of those nearby whether they do.
  template <class Intersects, class F>
  void each_hit_if(std::uint32_t t, Intersects&& intersects, F&& f) {
    grid().each_near(LatticeBox::around(shape(t)), [&](std::uint32_t other) {
      if (other != t && intersects(other)) f(other);
    });
  }
  // Whether the one intersects the other.
  bool hit(std::uint32_t t, std::uint32_t other) const {
    return hit(other, triangles_[t], shape(t), planes_[t]);
  }
  // The triangles that intersect others, of pairs of which one is movable, ascending.
  std::vector<std::uint32_t> find_intersecting();
  // Between these two, changes are quicker, and nothing may ask for intersections but clean_around().
  // If all changes were so, the second one returns the triangles that intersect others, of pairs of
  // which one has changed, ascending.
  void begin_changes();
  std::vector<std::uint32_t> end_changes();
  // Those that are said to do so, in all.
  const std::vector<std::uint32_t>& intersecting() const { return intersecting_; }
  void set_intersecting(std::vector<std::uint32_t> ascending) {
    intersecting_ = std::move(ascending);
  }
  // Those too that do so among `more`, which ascend.
  void add_intersecting(std::span<const std::uint32_t> more);
  // Leaves out those that do so no more. Precondition: since they were found all changes were clean().
  void recheck_intersecting() {
    std::erase_if(intersecting_, [&](std::uint32_t t) {
      bool any = false;
      if (alive(t)) each_hit(t, [&](std::uint32_t) { any = true; });
      return !any;
    });
  }
  // Leaves them out too, and takes in what the others intersect. So of a pair of which a neighbour may
  // not list the one it knows the other. The same precondition.
  void complete_intersecting();
  // Of those the pairs of which one is movable.
  std::size_t count_pairs();

  // What a change does beside its triangles: `moved` lies at `to`; where it is not none, `gone` is no
  // more.
  struct Step {
    std::uint32_t moved = none;
    LatticePoint to{};
    std::uint32_t gone = none;
    bool leaves_sample = true;  // the place that `moved` leaves was one of the surface
  };
  // Whether no sample of the change's old triangles, and no place that a vertex leaves, would be
  // further from the new ones than `most`, or than it is now. Of the new ones only those count that
  // separate what its triangle does; a place that a vertex leaves is one of each sheet there.
  bool keeps_samples(const Change& change, const Step& step, double most) {
    return measure(change, step, most, most) <= most * most;
  }
  // The square of the least distance for which keeps_samples() would say yes: no more exactly than
  // whether it is more than `most`, or no more than `enough`. Quicker than that, as which triangle is
  // nearest to a sample does not matter.
  double squared_reach(const Change& change, const Step& step, double enough, double most) {
    return measure(change, step, enough, most);
  }
  // Precondition: keeps_samples() has said yes to this change, and was not asked since. Samples go to
  // the nearest of the new triangles.
  void apply(const Change& change, const Step& step);
  void set_normals(std::uint32_t v, const std::array<PackedNormal, max_clusters>& normals) {
    if (!normals_.empty()) normals_[v] = normals;
  }
  bool has_normals() const { return !normals_.empty(); }
  const std::array<PackedNormal, max_clusters>* normals(std::uint32_t v) const {
    return normals_.empty() ? nullptr : &normals_[v];
  }

 private:
  // squared_reach(). places_ tells the nearest triangles, unless it is more than `most`.
  double measure(const Change& change, const Step& step, double enough, double most);
  // The places that vertices leave.
  void note_left(const Change& change, const Step& step);
  void note_left(const Change& change, std::uint32_t v);
  void take_samples(const RefineMesh& mesh, const std::vector<std::uint32_t>& place);
  TriangleGrid& grid();
  void mark_old(const Change& change);
  void link(std::uint32_t t);
  void unlink(std::uint32_t t);
  void find_freedom(std::uint32_t v, std::vector<LinkEdge>& link);  // link: room for it
  // How far within the samples' box; 0 or less beyond it. Precondition: there is one.
  std::int32_t depth(const LatticePoint& p) const;
  bool hit(std::uint32_t t, const Corners& corners, const LatticeTriangle& own,
           const Index3& normal) const;
  bool apart(std::uint32_t t, const LatticeTriangle& shape, const Index3& normal) const;
  // A triangle around a vertex, the vertex first.
  struct Rib {
    const LatticePoint *at, *next, *last;
    const Index3* normal;
    std::uint32_t triangle;  // none: a new one
    Corners corners;         // in that order
    LatticeTriangle shape() const { return {*at, *next, *last}; }
  };
  bool ribs_intersect(std::size_t i, std::size_t j) const;
  void gather_umbrella(std::uint32_t v, const Change* change);
  Along proper_along(std::uint32_t v) const;
  bool is_proper_along_axis(int axis, bool up) const;
  bool stays_proper(std::uint32_t v, const Change& change);
  void keep_proper(const Change& change, const Step& step);
  template <class Takes>
  void add_intersecting_apart(Takes&& takes, std::vector<std::uint32_t>& bad) const;
  template <class F>
  bool with_uses(const Change& change, F&& f);
  bool umbrellas_are_clean(const Change& change);
  bool others_stay_apart(const Change& change);

  NearestTriangles nearest_;  // of the change at hand; first, as it has the alignment of vectors
  LatticeBox box_;
  std::optional<LatticeBox> samples_box_;
  std::vector<LatticePoint> positions_;
  std::vector<VertexId> ids_;
  std::vector<LatticePoint> aims_;
  std::vector<std::array<PackedNormal, max_clusters>> normals_;
  std::vector<Corners> triangles_;           // dead: none
  std::vector<MaterialPair> sides_;          // of triangles; what is made of them keeps theirs
  std::vector<std::uint32_t> heads_, next_;  // corners, 3 triangle + k, of each vertex
  std::vector<Freedom> freedom_;
  std::vector<StarKind> kinds_;
  std::vector<std::uint32_t> versions_;
  std::vector<LatticePoint> samples_;
  std::vector<std::uint32_t> sample_heads_, sample_next_;  // of each triangle
  // Of the samples keeps_samples() has looked at last, in its order: where they would come to lie.
  struct Left {
    LatticePoint place;
    MaterialPair sides;
  };
  std::vector<Left> left_;
  std::vector<std::uint32_t> places_, moved_samples_;
  // Made when it is first asked for, which it never is of many meshes, and again after many changes.
  std::optional<TriangleGrid> grid_;
  // Of triangles that have changed since begin_changes(), 1.
  std::vector<std::uint8_t> changed_;
  std::vector<std::uint32_t> marks_;  // of triangles: equal to mark_ where they are to go
  std::uint32_t mark_ = 0;
  std::vector<std::uint8_t> movable_;  // triangles; what is made of them stays so
  std::vector<std::uint32_t> intersecting_;
  std::vector<Index3> planes_;  // of triangles: their exact normals
  // Of each vertex the new triangles of the change at hand that use it, one bit each; and the vertices
  // that have any.
  std::vector<std::uint64_t> uses_;
  std::vector<std::uint32_t> used_;
  std::vector<Rib> umbrella_;
  // Of vertices: along which direction all triangles around it are known to run the same way and once
  // around, as they are now.
  std::vector<Along> proper_;
};

}  // namespace voxweld
