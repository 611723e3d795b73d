// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, sections 3.1
// and 4; Schaefer, Ju, Warren, "Manifold Dual Contouring", 2007, sections 3 and 4. Where it differs:
// bottom-up over linear levels, eight clusters at a time; for clusters see
// stages/contouring/node_shape.h; where signs at half a node's side show one disc, no shape is made.
#include "stages/build/brick_nodes.h"

#include <algorithm>

namespace voxweld {
namespace {

CellSigns corners_of(const SignGrid& signs, LocalCell c, int side) {
  unsigned corners = 0;
  for (int i = 0; i < 8; ++i)
    corners |= static_cast<unsigned>(signs.inside(c.x + side * (i & 1), c.y + side * (i >> 1 & 1),
                                                  c.z + side * (i >> 2)))
               << i;
  return static_cast<CellSigns>(corners);
}

}  // namespace

void BrickNodes::Shapes::clear(std::size_t first) {
  first_node = first;
  place.clear();
  first_cluster.assign(1, 0);
  first_curve.assign(1, 0);
  first_pair.assign(1, 0);
  euler.clear();
  curves.clear();
  pairs.clear();
}

void BrickNodes::Shapes::add(std::size_t node, const NodeShape& shape) {
  place.resize(node - first_node, no_cluster);
  place.push_back(static_cast<std::uint32_t>(first_cluster.size() - 1));
  euler.insert(euler.end(), shape.euler.begin(), shape.euler.end());
  curves.insert(curves.end(), shape.curves.begin(), shape.curves.end());
  pairs.insert(pairs.end(), shape.pairs.begin(), shape.pairs.end());
  first_cluster.push_back(static_cast<std::uint32_t>(euler.size()));
  first_curve.push_back(static_cast<std::uint32_t>(curves.size()));
  first_pair.push_back(static_cast<std::uint32_t>(pairs.size()));
}

NodeShape BrickNodes::Shapes::of(std::size_t node) const {
  const std::size_t at = place[node - first_node];
  const auto part = [at](const auto& all, const std::vector<std::uint32_t>& first) {
    return std::span(all.data() + first[at], first[at + 1] - first[at]);
  };
  return {part(euler, first_cluster), part(curves, first_curve), part(pairs, first_pair)};
}

// Precondition: the ends of the edge have different signs, and it is crossed once.
Crossing BrickNodes::crossing_on(CellKey node, int edge) const {
  const int axis = edge >> 2, corner = edge_corners(edge).low;
  const Index3 low = node.lo() + Index3{corner & 1, corner >> 1 & 1, corner >> 2} * node.side();
  const auto inside_at = [&](std::int64_t along) {
    Index3 p = low - frame_.origin;
    p[axis] += along;
    return signs_->inside(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z));
  };
  const bool first = inside_at(0);
  std::int64_t before = 0, after = node.side();
  while (after - before > 1) {
    const std::int64_t middle = (before + after) / 2;
    (inside_at(middle) == first ? before : after) = middle;
  }
  Index3 at = low;
  at[axis] += before;
  return Crossing::make(axis, at);
}

NodeShape BrickNodes::simple_shape(int l, std::uint32_t code, SimpleShape& made) const {
  static constexpr std::array<std::int32_t, 1> disc = {1};
  const LocalCell c = decode_local(code << (3 * l));
  const CellSigns signs = corners_of(*signs_, c, 1 << l);
  const Index3 lo = frame_.origin + Index3{c.x, c.y, c.z};
  const CellKey key{l, {lo.x >> l, lo.y >> l, lo.z >> l}};
  std::array<Crossing, 12> crossing;
  const auto crosses = [signs](int edge) {
    const EdgeCorners ends = edge_corners(edge);
    return ((signs >> ends.low ^ signs >> ends.high) & 1) != 0;
  };
  for (int edge = 0; edge < 12; ++edge)
    if (crosses(edge)) crossing[static_cast<std::size_t>(edge)] = crossing_on(key, edge);
  made.count = 0;
  for (int face = 0; face < 6; ++face) {
    const auto corners = face_corners(face);
    std::array<Crossing, 2> ends;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const int edge = edge_between(corners[i], corners[(i + 1) % 4]);
      if (crosses(edge)) ends[count++] = crossing[static_cast<std::size_t>(edge)];
    }
    if (count == 2)
      made.curves[made.count++] = {std::min(ends[0], ends[1]), std::max(ends[0], ends[1]), 0,
                                   static_cast<std::uint16_t>(face), 0};
  }
  return {disc, {made.curves.data(), made.count}, {}};
}

NodeShape BrickNodes::root_shape() {
  const int top = frame_.level;
  if (level(top).kinds[0] == NodeKind::simple) return simple_shape(top, 0, simple_[0]);
  return shapes(top).of(0);
}

bool BrickNodes::is_whole() const {
  const NodeLevel& top = level(frame_.level);
  return top.kinds[0] == NodeKind::simple && top.clusters[0].collapses;
}

void BrickNodes::simplify(const BrickFrame& frame, const SignGrid& signs, const ActiveCells& cells,
                          const HermiteEdges& edges, const ContourParameters& parameters) {
  frame_ = frame;
  parameters_ = parameters;
  signs_ = &signs;
  simplify(signs, cells, edges);
}

void BrickNodes::simplify(const BrickFrame& frame, const LabelGrid& labels,
                          const ActiveCells& cells, const HermiteEdges& edges,
                          const ContourParameters& parameters) {
  frame_ = frame;
  parameters_ = parameters;
  signs_ = nullptr;
  simplify(labels, cells, edges);
}

void BrickNodes::simplify(const CollapseRule& rule, const ActiveCells& cells,
                          const HermiteEdges& edges) {
  const SimplifyParameters& simplify = parameters_.simplify;
  rule_ = &rule;
  cells_ = &cells;
  free_ = simplify.topology == Topology::free;
  by_sheets_ = simplify.enabled && simplify.topology == Topology::manifold && signs_ != nullptr;
  highest_ = simplify.enabled ? std::min(frame_.level, frame_.domain_level) : 0;
  // "free" may collapse what no sign test allows, up to the smallest brick: polygons are then
  // decided edge by edge inside one brick (brick_polygons.cpp), the same for every brick size.
  if (free_) highest_ = std::min(highest_, min_brick_level);
  begin_levels();
  make_nodes(edges);
}

void BrickNodes::begin_levels() {
  levels_.resize(static_cast<std::size_t>(frame_.level) + 1);
  shapes_.resize(levels_.size());
  for (Shapes& shapes : shapes_) shapes.clear(0);
  for (NodeLevel& level : levels_) {
    level.codes.clear();
    level.first_child.assign(1, 0);
    level.first_cluster.assign(1, 0);
    level.kinds.clear();
    level.closes.clear();
    level.clusters.clear();
    level.first_vertex = level.first_qef = 0;
    level.vertices.clear();
    level.qefs.clear();
  }
}

// Appends the nodes above a range of the level below, and their clusters, without QEFs.
BrickNodes::Range BrickNodes::make_level(int l, Range range) {
  const NodeLevel& below = level(l - 1);
  NodeLevel& at = levels_[static_cast<std::size_t>(l)];
  const std::size_t first = at.codes.size();
  if (l < block_top()) shapes(l).clear(first);
  for (std::size_t i = range.begin; i < range.end;) {
    const std::uint32_t code = below.codes[i] >> 3;
    while (i < range.end && below.codes[i] >> 3 == code) ++i;
    at.codes.push_back(code);
    at.first_child.push_back(static_cast<std::uint32_t>(i));
    at.kinds.push_back(NodeKind::blocked);
    at.closes.push_back(0);
    add_clusters(l, at.codes.size() - 1);
    at.first_cluster.push_back(static_cast<std::uint32_t>(at.clusters.size()));
  }
  return {first, at.codes.size()};
}

NodeKind BrickNodes::classify(int l, std::size_t node) {
  const NodeLevel& at = level(l);
  const NodeLevel& below = level(l - 1);
  if (l > highest_) return NodeKind::blocked;
  bool simple = options_.signs;
  for (std::uint32_t child = at.first_child[node]; child < at.first_child[node + 1]; ++child) {
    if (below.kinds[child] == NodeKind::blocked) return NodeKind::blocked;
    if (!by_sheets_ && !below.clusters[below.first_cluster[child]].collapses)
      return NodeKind::blocked;
    simple = simple && below.kinds[child] == NodeKind::simple;
  }
  if (free_) return NodeKind::simple;
  const LocalCell c = decode_local(at.codes[node] << (3 * l));
  if (simple && rule_->allows(c.x, c.y, c.z, 1 << l)) return NodeKind::simple;
  return by_sheets_ ? NodeKind::shaped : NodeKind::blocked;
}

void BrickNodes::shape_node(int l, std::size_t node) {
  const NodeLevel& at = level(l);
  const NodeLevel& below = level(l - 1);
  const LocalCell c = decode_local(at.codes[node] << (3 * l));
  const Index3 lo = frame_.origin + Index3{c.x, c.y, c.z};
  merger_.begin({l, {lo.x >> l, lo.y >> l, lo.z >> l}});
  for (std::uint32_t child = at.first_child[node]; child < at.first_child[node + 1]; ++child) {
    const auto octant = static_cast<int>(below.codes[child] & 7);
    if (l == 1)
      merger_.add_cell(octant, cells_->signs(child), cells_->joined(child));
    else if (below.kinds[child] == NodeKind::shaped)
      merger_.add(octant, shapes(l - 1).of(child));
    else
      merger_.add(octant, simple_shape(l - 1, below.codes[child],
                                       simple_[static_cast<std::size_t>(octant)]));
  }
  merger_.merge();
}

// The node's clusters, without their QEFs, and which of those below they hold.
void BrickNodes::add_clusters(int l, std::size_t node) {
  NodeLevel& at = levels_[static_cast<std::size_t>(l)];
  NodeLevel& below = levels_[static_cast<std::size_t>(l) - 1];
  const auto first = static_cast<std::uint32_t>(at.clusters.size());
  const std::uint32_t begin = below.first_cluster[at.first_child[node]],
                      end = below.first_cluster[at.first_child[node + 1]];
  at.kinds[node] = classify(l, node);
  if (at.kinds[node] == NodeKind::blocked) return;
  if (at.kinds[node] == NodeKind::simple) {
    for (std::uint32_t i = begin; i < end; ++i) below.clusters[i].parent = first;
    SheetCluster& cluster = at.clusters.emplace_back();
    cluster.first = below.clusters[begin].first;
    cluster.collapses = true;
    return;
  }
  shape_node(l, node);
  const NodeShape shape = merger_.shape();
  if (is_sealed(l, shape, parameters_.simplify.sealing)) {
    at.kinds[node] = NodeKind::blocked;
    return;
  }
  shapes(l).add(node, shape);
  bool closes = merger_.closes();
  for (std::uint32_t child = at.first_child[node]; child < at.first_child[node + 1]; ++child)
    closes = closes || below.closes[child] != 0;
  at.closes[node] = closes ? 1 : 0;
  at.clusters.resize(first + shape.euler.size());
  for (std::uint32_t i = end; i-- > begin;) {
    const std::uint32_t cluster = merger_.cluster_of()[i - begin];
    if (cluster == no_cluster) continue;
    below.clusters[i].parent = first + cluster;
    at.clusters[first + cluster].first = below.clusters[i].first;
  }
  for (std::size_t i = 0; i < shape.euler.size(); ++i)
    at.clusters[first + i].collapses = merger_.may_collapse(i);
}

}  // namespace voxweld
