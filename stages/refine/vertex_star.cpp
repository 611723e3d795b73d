#include "stages/refine/vertex_star.h"

#include <algorithm>

namespace voxweld {
namespace {

class Link {
 public:
  explicit Link(std::span<const LinkEdge> edges) : edges_(edges) {}

  std::size_t degree(std::uint32_t node) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        edges_, [&](const LinkEdge& e) { return e.from == node || e.to == node; }));
  }

  // From `start` along an edge there, past nodes of two edges.
  struct Path {
    std::size_t edges = 0;
    std::uint32_t end = 0;
    bool sound = true;  // one sheet of one direction
  };
  Path path(std::uint32_t start, std::size_t edge) const {
    Path path{1, other_end(edge, start)};
    const bool forwards = edges_[edge].from == start;
    while (path.end != start && degree(path.end) == 2 && path.edges <= edges_.size()) {
      const std::size_t next = other_edge(edge, path.end);
      path.sound = path.sound && (edges_[next].from == path.end) == forwards &&
                   edges_[next].sides == edges_[edge].sides;
      edge = next;
      path.end = other_end(edge, path.end);
      ++path.edges;
    }
    return path;
  }

 private:
  std::uint32_t other_end(std::size_t edge, std::uint32_t node) const {
    return edges_[edge].from == node ? edges_[edge].to : edges_[edge].from;
  }
  std::size_t other_edge(std::size_t edge, std::uint32_t node) const {
    std::size_t i = 0;
    while (i == edge || (edges_[i].from != node && edges_[i].to != node)) ++i;
    return i;
  }

  std::span<const LinkEdge> edges_;
};

// One sheet once around, of which each edge begins where another one ends: nearly all stars.
bool is_ring(std::span<const LinkEdge> edges) {
  std::uint32_t node = edges[0].to;
  std::size_t seen = 1;
  for (; node != edges[0].from && seen < edges.size(); ++seen) {
    const auto next = std::ranges::find(edges, node, &LinkEdge::from);
    if (next == edges.end() || next->sides != edges[0].sides) return false;
    node = next->to;
  }
  // It came back by as many edges as there are: so it went by each of them once, since the way on is
  // always the same from the same node.
  return node == edges[0].from && seen == edges.size();
}

// One sheet from the one end to the other. Precondition: one edge begins or ends at ends[0].
bool is_fan(const Link& link, std::span<const LinkEdge> edges, const std::uint32_t (&ends)[2]) {
  std::size_t first = 0;
  while (edges[first].from != ends[0] && edges[first].to != ends[0]) ++first;
  const Link::Path fan = link.path(ends[0], first);
  return fan.sound && fan.end == ends[1] && fan.edges == edges.size();
}

}  // namespace

StarKind kind_of_star(std::span<const LinkEdge> edges) {
  if (edges.empty()) return StarKind::point;
  if (edges.size() > 2 && is_ring(edges)) return StarKind::disc;
  const Link link(edges);
  std::uint32_t ends[2] = {};
  std::size_t count = 0;
  for (const LinkEdge& edge : edges)
    for (const std::uint32_t node : {edge.from, edge.to}) {
      if ((count > 0 && node == ends[0]) || (count > 1 && node == ends[1])) continue;
      if (link.degree(node) == 2) continue;
      if (count == 2) return StarKind::point;
      ends[count++] = node;
    }
  if (count == 0) {
    if (edges.size() < 3) return StarKind::point;
    const Link::Path ring = link.path(edges[0].from, 0);
    return ring.sound && ring.edges == edges.size() ? StarKind::disc : StarKind::point;
  }
  if (count == 1) return StarKind::point;
  if (link.degree(ends[0]) == 1) return is_fan(link, edges, ends) ? StarKind::rim : StarKind::point;
  // Each page runs from the one end of the line to the other. Of pages of one triangle, which have
  // the same three corners, there can be but one.
  std::size_t covered = 0, single = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].from != ends[0] && edges[i].to != ends[0]) continue;
    const Link::Path page = link.path(ends[0], i);
    if (!page.sound || page.end != ends[1]) return StarKind::point;
    covered += page.edges;
    single += page.edges == 1 ? 1 : 0;
  }
  return covered == edges.size() && single < 2 ? StarKind::line : StarKind::point;
}

}  // namespace voxweld
