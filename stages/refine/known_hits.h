// Which triangles intersect which, remembered while a mesh changes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/refine/edit_mesh.h"

namespace voxweld {

// What a triangle intersects is looked up when it is first asked for. After that it is kept up to date,
// so before() and after() have to be told of each change.
class KnownHits {
 public:
  // mesh: outlives it.
  explicit KnownHits(EditMesh& mesh) : mesh_(mesh), heads_(mesh.triangles(), unknown) {}

  // f(other) for each triangle that intersects t, in no order that says anything. Precondition: f asks
  // nothing of this object.
  template <class F>
  void each(std::uint32_t t, F&& f) {
    if (heads_[t] == unknown) look_up(t);
    for (std::uint32_t n = heads_[t]; n != end; n = nodes_[n].next) f(nodes_[n].triangle);
  }
  bool any(std::uint32_t t) {
    if (heads_[t] == unknown) look_up(t);
    return heads_[t] != end;
  }
  // The pairs of which one is in `some`; and the triangles beside these that are in such a pair, each
  // once, ascending.
  std::size_t pairs_of(std::span<const std::uint32_t> some, std::vector<std::uint32_t>& others);

  // Before and after the mesh applies a change. Between them nothing may be asked.
  void before(const Change& change);
  void after(const Change& change);

 private:
  static constexpr std::uint32_t end = 0xffffffffu, unknown = 0xfffffffeu;
  struct Node {
    std::uint32_t triangle, next;
  };

  void look_up(std::uint32_t t);
  void add(std::uint32_t t, std::uint32_t other);
  void remove(std::uint32_t t, std::uint32_t other);
  bool holds(std::uint32_t t, std::uint32_t other) const;
  void forget(std::uint32_t t);

  EditMesh& mesh_;
  std::vector<std::uint32_t> heads_;  // of each triangle its first node
  std::vector<Node> nodes_;
  std::uint32_t free_ = end;  // nodes that are not in use
};

}  // namespace voxweld
