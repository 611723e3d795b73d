// Based on: Schaefer, Ju, Warren, "Manifold Dual Contouring", 2007, sections 3 and 4. Where it
// differs: see stages/contouring/node_shape.h; bottom-up over linear levels, eight clusters at a
// time; where signs at half a node's side show one disc, no shape is made.
#include "stages/build/brick_clusters.h"

#include "stages/build/cell_planes.h"
#include "stages/contouring/cluster_sum.h"

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

void BrickClusters::Shapes::clear(std::size_t nodes) {
  place.assign(nodes, no_cluster);
  first_cluster.assign(1, 0);
  first_curve.assign(1, 0);
  first_pair.assign(1, 0);
  euler.clear();
  curves.clear();
  pairs.clear();
}

void BrickClusters::Shapes::add(std::size_t node, const NodeShape& shape) {
  place[node] = static_cast<std::uint32_t>(first_cluster.size() - 1);
  euler.insert(euler.end(), shape.euler.begin(), shape.euler.end());
  curves.insert(curves.end(), shape.curves.begin(), shape.curves.end());
  pairs.insert(pairs.end(), shape.pairs.begin(), shape.pairs.end());
  first_cluster.push_back(static_cast<std::uint32_t>(euler.size()));
  first_curve.push_back(static_cast<std::uint32_t>(curves.size()));
  first_pair.push_back(static_cast<std::uint32_t>(pairs.size()));
}

NodeShape BrickClusters::shape_of(const Shapes& shapes, std::size_t node) {
  const std::size_t at = shapes.place[node];
  const auto part = [at](const auto& all, const std::vector<std::uint32_t>& first) {
    return std::span(all.data() + first[at], first[at + 1] - first[at]);
  };
  return {part(shapes.euler, shapes.first_cluster), part(shapes.curves, shapes.first_curve),
          part(shapes.pairs, shapes.first_pair)};
}

// Precondition: the ends of the edge have different signs, and it is crossed once.
Crossing BrickClusters::crossing_on(CellKey node, int edge) const {
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

NodeShape BrickClusters::simple_shape(int l, std::uint32_t code, SimpleShape& made) const {
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

NodeShape BrickClusters::root_shape() {
  const int top = frame_.level;
  if (level(top).kinds[0] == NodeKind::simple) return simple_shape(top, 0, simple_[0]);
  return shape_of(shapes_, 0);
}

void BrickClusters::simplify(const BrickFrame& frame, const SignGrid& signs,
                             const ActiveCells& cells, const HermiteEdges& edges,
                             const ContourParameters& parameters) {
  frame_ = frame;
  signs_ = &signs;
  cells_ = &cells;
  parameters_ = parameters;
  levels_.resize(static_cast<std::size_t>(frame.level) + 1);
  make_cells(cells, edges);
  for (int l = 1; l <= frame.level; ++l) {
    make_level(l);
    std::swap(shapes_, shapes_below_);
    const std::size_t nodes = level(l).codes.size();
    shapes_.clear(nodes);
    for (std::size_t node = 0; node < nodes; ++node) add_clusters(l, node);
    levels_[static_cast<std::size_t>(l)].first_cluster.push_back(
        static_cast<std::uint32_t>(level(l).clusters.size()));
    merge_level(l);
  }
}

void BrickClusters::make_cells(const ActiveCells& cells, const HermiteEdges& edges) {
  ClusterLevel& level = levels_[0];
  level.codes = cells.codes();
  level.kinds.resize(cells.size());
  level.closes.assign(cells.size(), 0);
  level.first_cluster.resize(cells.size() + 1);
  level.clusters.clear();
  NodeSolver solver(parameters_);
  std::size_t pending = 0;
  const auto flush = [&] {
    solver.reduce();
    for (std::size_t i = 0; i < pending; ++i)
      level.clusters[level.clusters.size() - pending + i].qef = solver.qef(i);
    pending = 0;
    solver.clear_planes();
  };
  solver.clear_planes();
  SheetPlanes planes;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellSheets& sheets = cells.sheets(i);
    level.first_cluster[i] = static_cast<std::uint32_t>(level.clusters.size());
    level.kinds[i] = options_.signs && cells.collapses(i) ? NodeKind::simple : NodeKind::shaped;
    for (int sheet = 0; sheet < sheets.sheets; ++sheet) {
      gather_planes(cells.at(i), sheets, sheets.sheets == 1 ? all_sheets : sheet, edges,
                    parameters_.spacing, planes);
      SheetCluster& cluster = level.clusters.emplace_back();
      cluster.normals = cluster_normals(planes.normal_span(), NormalSense::outward);
      cluster.first = LeafCode::make(cells.code(i), 0, sheet);
      cluster.collapses = true;
      if (solver.needs_centres())
        solver.set_centre(pending, node_centre(frame_, 0, cells.code(i), parameters_.spacing));
      solver.set_planes(pending, planes.planes.data(), planes.count);
      if (++pending == lanes) flush();
    }
  }
  if (pending > 0) flush();
  level.first_cluster[cells.size()] = static_cast<std::uint32_t>(level.clusters.size());
}

void BrickClusters::make_level(int l) {
  const ClusterLevel& below = levels_[static_cast<std::size_t>(l) - 1];
  ClusterLevel& level = levels_[static_cast<std::size_t>(l)];
  level.codes.clear();
  level.first_child.clear();
  level.first_cluster.clear();
  level.clusters.clear();
  for (std::size_t i = 0; i < below.codes.size(); ++i) {
    const std::uint32_t parent = below.codes[i] >> 3;
    if (!level.codes.empty() && level.codes.back() == parent) continue;
    level.codes.push_back(parent);
    level.first_child.push_back(static_cast<std::uint32_t>(i));
  }
  level.first_child.push_back(static_cast<std::uint32_t>(below.codes.size()));
  level.kinds.assign(level.codes.size(), NodeKind::blocked);
  level.closes.assign(level.codes.size(), 0);
}

NodeKind BrickClusters::classify(int l, std::size_t node) {
  const ClusterLevel& at = level(l);
  const ClusterLevel& below = level(l - 1);
  if (l > frame_.domain_level) return NodeKind::blocked;
  bool simple = options_.signs;
  for (std::uint32_t child = at.first_child[node]; child < at.first_child[node + 1]; ++child) {
    if (below.kinds[child] == NodeKind::blocked) return NodeKind::blocked;
    simple = simple && below.kinds[child] == NodeKind::simple;
  }
  const LocalCell c = decode_local(at.codes[node] << (3 * l));
  return simple && signs_->allows(c.x, c.y, c.z, 1 << l) ? NodeKind::simple : NodeKind::shaped;
}

void BrickClusters::shape_node(int l, std::size_t node) {
  const ClusterLevel& at = level(l);
  const ClusterLevel& below = level(l - 1);
  const LocalCell c = decode_local(at.codes[node] << (3 * l));
  const Index3 lo = frame_.origin + Index3{c.x, c.y, c.z};
  merger_.begin({l, {lo.x >> l, lo.y >> l, lo.z >> l}});
  for (std::uint32_t child = at.first_child[node]; child < at.first_child[node + 1]; ++child) {
    const auto octant = static_cast<int>(below.codes[child] & 7);
    if (l == 1)
      merger_.add_cell(octant, cells_->signs(child), cells_->joined(child));
    else if (below.kinds[child] == NodeKind::shaped)
      merger_.add(octant, shape_of(shapes_below_, child));
    else
      merger_.add(octant, simple_shape(l - 1, below.codes[child],
                                       simple_[static_cast<std::size_t>(octant)]));
  }
  merger_.merge();
}

// The node's clusters, without their QEFs, and which of those below they hold.
void BrickClusters::add_clusters(int l, std::size_t node) {
  ClusterLevel& at = levels_[static_cast<std::size_t>(l)];
  ClusterLevel& below = levels_[static_cast<std::size_t>(l) - 1];
  const auto first = static_cast<std::uint32_t>(at.clusters.size());
  at.first_cluster.push_back(first);
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
  if (is_sealed(l, shape)) {
    at.kinds[node] = NodeKind::blocked;
    return;
  }
  shapes_.add(node, shape);
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

// Clusters on their way through the solver, as many as it takes at once.
class BrickClusters::MergeBatch {
 public:
  // collapsing: solves them too, and says which are within the tolerance.
  MergeBatch(BrickClusters& brick, int l, bool collapsing)
      : brick_(brick),
        l_(l),
        collapsing_(collapsing),
        at_(brick.levels_[static_cast<std::size_t>(l)]),
        below_(brick.levels_[static_cast<std::size_t>(l) - 1]),
        solver_(brick.parameters_),
        sum_(brick.parameters_) {
    solver_.clear_children();
  }

  void add(std::size_t node, std::uint32_t cluster) {
    if (solver_.needs_centres()) solver_.set_centre(count_, centre(l_, at_.codes[node]));
    sum_.begin(solver_, count_);
    for (std::uint32_t child = at_.first_child[node]; child < at_.first_child[node + 1]; ++child)
      for (std::uint32_t i = below_.first_cluster[child]; i < below_.first_cluster[child + 1];
           ++i) {
        const SheetCluster& part = below_.clusters[i];
        if (part.parent == cluster)
          sum_.add(static_cast<int>(below_.codes[child] & 7), part.qef, part.normals,
                   solver_.needs_centres() ? centre(l_ - 1, below_.codes[child]) : Vec3{});
      }
    at_.clusters[cluster].normals = sum_.finish();
    clusters_[count_] = cluster;
    if (++count_ == lanes) flush();
  }
  void flush() {
    if (count_ == 0) return;
    solver_.merge(l_ - 1);
    if (collapsing_) solver_.solve(l_, count_);
    for (std::size_t i = 0; i < count_; ++i) {
      SheetCluster& cluster = at_.clusters[clusters_[i]];
      cluster.qef = solver_.qef(i);
      if (!collapsing_) continue;
      cluster.solution = solver_.solution(i);
      cluster.collapses = solver_.within_tolerance(cluster.solution);
    }
    count_ = 0;
    solver_.clear_children();
  }

 private:
  Vec3 centre(int l, std::uint32_t code) const {
    return node_centre(brick_.frame_, l, code, brick_.parameters_.spacing);
  }
  BrickClusters& brick_;
  int l_;
  bool collapsing_;
  ClusterLevel& at_;
  const ClusterLevel& below_;
  NodeSolver solver_;
  ClusterSum sum_;
  std::array<std::uint32_t, lanes> clusters_{};
  std::size_t count_ = 0;
};

void BrickClusters::merge_level(int l) {
  const ClusterLevel& at = level(l);
  MergeBatch collapsing(*this, l, true), others(*this, l, false);
  for (std::size_t node = 0; node < at.codes.size(); ++node)
    for (std::uint32_t i = at.first_cluster[node]; i < at.first_cluster[node + 1]; ++i)
      (at.clusters[i].collapses ? collapsing : others).add(node, i);
  collapsing.flush();
  others.flush();
}

}  // namespace voxweld
