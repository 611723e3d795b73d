#include "stages/contouring/node_shape.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace voxweld {
namespace {

constexpr std::array<std::int32_t, 4> cell_euler = {1, 1, 1, 1};

[[noreturn]] void fail(const char* what) {
  throw std::logic_error(std::string("shapes of an octree node's children: ") + what);
}

// The arcs of a finest cell, as curves of its faces with its edges for ends.
struct CellArc {
  std::uint8_t face, low, high, sheet;
};
struct CellArcs {
  std::array<CellArc, 12> arcs{};
  std::size_t count = 0;
  std::array<CurvePair, 6> pairs{};
  std::size_t pair_count = 0;
};

Crossing crossing_of(int edge, Index3 cell) {
  const int low = edge_corners(edge).low;
  return Crossing::make(edge >> 2, cell + Index3{low & 1, low >> 1 & 1, low >> 2});
}

bool inside(CellSigns signs, int corner) {
  return (signs >> corner & 1) != 0;
}

class ArcTable {
 public:
  ArcTable() {
    for (unsigned signs = 0; signs < 256; ++signs)
      for (int joined = 0; joined < 2; ++joined)
        fill(static_cast<CellSigns>(signs), joined != 0,
             arcs_[static_cast<std::size_t>(joined)][signs]);
  }
  const CellArcs& of(CellSigns signs, bool joined) const { return arcs_[joined][signs]; }

 private:
  static void fill(CellSigns signs, bool joined, CellArcs& cell) {
    const CellSheets& sheets = cell_sheets(signs, joined);
    const int flipped = joined ? problem_face(signs) : -1;
    for (int face = 0; face < 6; ++face) {
      const auto c = face_corners(face);
      std::array<int, 4> edges{};  // that cross, around the face
      std::size_t crossing = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (inside(signs, c[i]) != inside(signs, c[(i + 1) % 4]))
          edges[crossing++] = edge_between(c[i], c[(i + 1) % 4]);
      if (crossing == 0) continue;
      if (crossing == 2) {
        add(face, edges[0], edges[1], sheets, cell);
        continue;
      }
      // Ambiguous: arcs go around the inside corners, or around the others. edges[i] lies between
      // c[i] and c[i + 1].
      const std::size_t around = inside(signs, c[0]) != (face == flipped) ? 0 : 1;
      const auto first = static_cast<std::uint32_t>(cell.count);
      for (const std::size_t i : {around, around + 2})
        add(face, edges[i], edges[(i + 3) % 4], sheets, cell);
      if (before(cell.arcs[first + 1].low, cell.arcs[first].low))
        std::swap(cell.arcs[first], cell.arcs[first + 1]);
      cell.pairs[cell.pair_count++] = {first, first + 1};
    }
  }
  static bool before(int a, int b) { return crossing_of(a, {}) < crossing_of(b, {}); }
  static void add(int face, int a, int b, const CellSheets& sheets, CellArcs& cell) {
    if (before(b, a)) std::swap(a, b);
    cell.arcs[cell.count++] = {static_cast<std::uint8_t>(face), static_cast<std::uint8_t>(a),
                               static_cast<std::uint8_t>(b),
                               sheets.sheet_of_edge[static_cast<std::size_t>(a)]};
  }

  std::array<std::array<CellArcs, 256>, 2> arcs_;
};

const CellArcs& cell_arcs(CellSigns signs, bool joined) {
  static const ArcTable table;
  return table.of(signs, joined);
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

bool is_sealed(int level, const NodeShape& shape, const SealingLimits& limits) {
  if (level == 4) return shape.euler.size() > limits.clusters_of_smallest;
  return level > 4 && (shape.euler.size() > limits.clusters || shape.curves.size() > limits.curves);
}

void ShapeMerger::begin(CellKey node) {
  node_ = node;
  const Index3 lo = node.lo();
  planes_ = {lo, lo + splat(node.side() / 2), lo + splat(node.side())};
  octants_ = 0;
  has_pairs_ = false;
}

void ShapeMerger::add_cell(int octant, CellSigns signs, bool joined) {
  const auto o = static_cast<std::size_t>(octant);
  const CellArcs& cell = cell_arcs(signs, joined);
  const Index3 at = node_.child(octant).at;
  for (std::size_t i = 0; i < cell.count; ++i) {
    const CellArc& arc = cell.arcs[i];
    cell_curves_[o][i] = {crossing_of(arc.low, at), crossing_of(arc.high, at), arc.sheet, arc.face,
                          0};
  }
  std::copy_n(cell.pairs.begin(), cell.pair_count, cell_pairs_[o].begin());
  add(octant, {{cell_euler.data(), cell_sheets(signs, joined).sheets},
               {cell_curves_[o].data(), cell.count},
               {cell_pairs_[o].data(), cell.pair_count}});
}

void ShapeMerger::add(int octant, const NodeShape& shape) {
  Child& child = children_[static_cast<std::size_t>(octant)];
  octants_ |= 1u << octant;
  child.shape = shape;
  has_pairs_ = has_pairs_ || !shape.pairs.empty();
  std::uint32_t at = 0;
  for (std::size_t face = 0; face < 6; ++face) {
    child.face_begin[face] = at;
    while (at < shape.curves.size() && shape.curves[at].face == face) ++at;
  }
  child.face_begin[6] = at;
}

std::uint32_t ShapeMerger::root(std::uint32_t cluster) {
  return find_root(parent_, cluster);
}

void ShapeMerger::unite(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

// The node's edge, if it lies on one.
int ShapeMerger::edge_of(Crossing end) const {
  const int axis = end.axis(), first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  const int high_first = end[first] == planes_[2][first] ? 1 : 0;
  const int high_second = end[second] == planes_[2][second] ? 1 : 0;
  return 4 * axis + high_first + 2 * high_second;
}

void ShapeMerger::merge() {
  std::uint32_t clusters = 0, curves = 0;
  child_euler_.clear();
  for (std::size_t o = 0; o < 8; ++o) {
    if ((octants_ >> o & 1u) == 0) continue;
    Child& child = children_[o];
    child.first_cluster = clusters;
    child.first_curve = curves;
    clusters += static_cast<std::uint32_t>(child.shape.euler.size());
    curves += static_cast<std::uint32_t>(child.shape.curves.size());
    child_euler_.insert(child_euler_.end(), child.shape.euler.begin(), child.shape.euler.end());
  }
  parent_.resize(clusters);
  std::iota(parent_.begin(), parent_.end(), 0u);
  ends_inside_.assign(clusters, 0);
  new_curve_.assign(curves, no_cluster);
  curves_.clear();
  pairs_.clear();

  join_inside();
  chain_.resize(curves);
  for (int face = 0; face < 6; ++face) {
    chain_face(face);
    if (has_pairs_) map_pairs(face);
  }
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  number_clusters();
  apply_rules();
}

void ShapeMerger::join_inside() {
  for (int axis = 0; axis < 3; ++axis)
    for (int octant = 0; octant < 8; ++octant)
      if ((octant >> axis & 1) == 0) join_across(axis, octant);
}

// The curves of the face between a child and the next along the axis: both have the same.
void ShapeMerger::join_across(int axis, int octant) {
  const auto curves_of = [&](int child, int face) {
    const auto c = static_cast<std::size_t>(child), f = static_cast<std::size_t>(face);
    if ((octants_ >> child & 1u) == 0) return std::span<const FaceCurve>{};
    return children_[c].shape.curves.subspan(
        children_[c].face_begin[f], children_[c].face_begin[f + 1] - children_[c].face_begin[f]);
  };
  const int next = octant | 1 << axis;
  const auto low = curves_of(octant, 2 * axis + 1), high = curves_of(next, 2 * axis);
  if (low.size() != high.size()) fail("one has more curves on a face than its neighbour");
  for (std::size_t i = 0; i < low.size(); ++i) {
    if (low[i].low != high[i].low || low[i].high != high[i].high)
      fail("curves of neighbours have other ends");
    const std::uint32_t mine =
        children_[static_cast<std::size_t>(octant)].first_cluster + low[i].cluster;
    unite(mine, children_[static_cast<std::size_t>(next)].first_cluster + high[i].cluster);
    if (low[i].closed != 0) continue;
    // So many arcs, and one crossing less between them. Those at the ends count if they lie inside
    // the node, and there four curves end.
    --child_euler_[mine];
    for (const Crossing end : {low[i].low, low[i].high})
      if (at_middle(end, axis)) ++ends_inside_[mine];
  }
}

// Those of four children that the face of the node is made of.
void ShapeMerger::gather_face(int face) {
  on_face_.clear();
  const int axis = face >> 1;
  const auto f = static_cast<std::size_t>(face);
  for (std::size_t o = 0; o < 8; ++o) {
    if ((octants_ >> o & 1u) == 0 || static_cast<int>(o >> axis & 1) != (face & 1)) continue;
    const Child& child = children_[o];
    for (std::uint32_t i = child.face_begin[f]; i < child.face_begin[f + 1]; ++i)
      on_face_.push_back({child.shape.curves[i], child.first_curve + i, child.first_cluster});
  }
}

// Where two curves of on_face_ have a common end, both become of one chain.
void ShapeMerger::chain_curves(int axis) {
  joints_.clear();
  for (const OnFace& at : on_face_) {
    chain_[at.number] = at.number;
    if (at.curve.closed != 0) continue;
    for (const Crossing end : {at.curve.low, at.curve.high})
      if (at_middle(end, axis)) joints_.push_back({end, at.number});
  }
  if (joints_.size() % 2 != 0) fail("a curve ends inside a face");
  std::sort(joints_.begin(), joints_.end());
  for (std::size_t i = 0; i < joints_.size(); i += 2) {
    if (joints_[i].at != joints_[i + 1].at) fail("a curve ends inside a face");
    const std::uint32_t a = find_root(chain_, joints_[i].curve),
                        b = find_root(chain_, joints_[i + 1].curve);
    chain_[std::max(a, b)] = std::min(a, b);
  }
}

// The curves of a face of the node from those of its children.
void ShapeMerger::chain_face(int face) {
  gather_face(face);
  if (on_face_.empty()) return;
  const int axis = face >> 1;
  const auto begin = static_cast<std::uint32_t>(curves_.size());
  chain_curves(axis);
  constexpr Crossing none{~std::uint64_t{0}};
  for (const OnFace& at : on_face_) {
    const FaceCurve& curve = at.curve;
    const std::uint32_t chain = find_root(chain_, at.number);
    if (new_curve_[chain] == no_cluster) {
      new_curve_[chain] = static_cast<std::uint32_t>(curves_.size());
      // Of a closed one `low` is the lowest crossing at which curves were joined, `high` unset.
      curves_.push_back(
          {none, none, at.first_cluster + curve.cluster, static_cast<std::uint16_t>(face), 1});
    }
    FaceCurve& joined = curves_[new_curve_[chain]];
    if (curve.closed != 0) {
      joined.low = joined.high = curve.low;
      continue;
    }
    for (const Crossing end : {curve.low, curve.high}) {
      if (at_middle(end, axis)) {
        if (joined.closed != 0) joined.low = std::min(joined.low, end);
      } else if (joined.closed != 0) {
        joined.closed = 0;
        joined.low = end;
      } else {
        joined.high = std::max(joined.low, end);
        joined.low = std::min(joined.low, end);
      }
    }
  }
  add_chains(begin);
}

// Those from `begin` on are of the face: makes them ready and puts them in order.
void ShapeMerger::add_chains(std::uint32_t begin) {
  const std::size_t count = curves_.size() - begin;
  for (std::size_t i = begin; i < curves_.size(); ++i)
    if (curves_[i].closed != 0) curves_[i].high = curves_[i].low;
  const auto lower = [](const FaceCurve& a, const FaceCurve& b) { return a.low < b.low; };
  const auto first = curves_.begin() + begin;
  if (count < 2 || std::is_sorted(first, curves_.end(), lower)) return;
  std::vector<std::uint32_t> order(count), place(count);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return lower(first[a], first[b]); });
  for (std::uint32_t i = 0; i < count; ++i) place[order[i]] = begin + i;
  std::sort(first, curves_.end(), lower);
  for (const OnFace& at : on_face_)
    if (chain_[at.number] == at.number)
      new_curve_[at.number] = place[new_curve_[at.number] - begin];
}

void ShapeMerger::map_pairs(int face) {
  for (std::size_t o = 0; o < 8; ++o) {
    if ((octants_ >> o & 1u) == 0 || static_cast<int>(o >> (face >> 1) & 1) != (face & 1)) continue;
    const Child& child = children_[o];
    for (const CurvePair& pair : child.shape.pairs) {
      if (child.shape.curves[pair.first].face != face) continue;
      const std::uint32_t a = new_curve_[find_root(chain_, child.first_curve + pair.first)],
                          b = new_curve_[find_root(chain_, child.first_curve + pair.second)];
      pairs_.push_back({std::min(a, b), std::max(a, b)});
    }
  }
}

void ShapeMerger::number_clusters() {
  constexpr std::uint32_t open = no_cluster - 1;
  cluster_of_.assign(parent_.size(), no_cluster);
  for (const FaceCurve& curve : curves_) cluster_of_[root(curve.cluster)] = open;
  euler_.clear();
  closes_ = false;
  for (std::uint32_t i = 0; i < cluster_of_.size(); ++i) {
    const std::uint32_t r = root(i);  // no later than i
    if (r == i && cluster_of_[i] == open) {
      cluster_of_[i] = static_cast<std::uint32_t>(euler_.size());
      euler_.push_back(0);
    } else {
      cluster_of_[i] = cluster_of_[r];
    }
    if (cluster_of_[i] == no_cluster)
      closes_ = true;
    else
      euler_[cluster_of_[i]] += child_euler_[i];
  }
  // Crossings inside: all four curves that end at one are of one cluster.
  ends_of_cluster_.assign(euler_.size(), 0);
  for (std::uint32_t i = 0; i < cluster_of_.size(); ++i)
    if (cluster_of_[i] != no_cluster) ends_of_cluster_[cluster_of_[i]] += ends_inside_[i];
  for (std::size_t c = 0; c < euler_.size(); ++c)
    euler_[c] += static_cast<std::int32_t>(ends_of_cluster_[c] / 4);
  for (FaceCurve& curve : curves_) curve.cluster = cluster_of_[curve.cluster];
}

void ShapeMerger::apply_rules() {
  tallies_.assign(euler_.size(), {});
  const auto count = [](std::uint8_t& n) { n = static_cast<std::uint8_t>(std::min(n + 1, 255)); };
  for (const FaceCurve& curve : curves_) {
    if (curve.closed != 0) continue;
    Tally& tally = tallies_[curve.cluster];
    count(tally.curves[curve.face]);
    for (const Crossing end : {curve.low, curve.high})
      count(tally.ends[static_cast<std::size_t>(edge_of(end))]);
  }
  allowed_.assign(euler_.size(), 1);
  for (std::size_t c = 0; c < euler_.size(); ++c) {
    const Tally& tally = tallies_[c];
    const auto over = [](const auto& counts, int most) {
      return std::any_of(counts.begin(), counts.end(), [&](std::uint8_t n) { return n > most; });
    };
    if (rules_.disc && euler_[c] != 1) allowed_[c] = 0;
    if (rules_.edge_once && over(tally.ends, 2)) allowed_[c] = 0;
    if (rules_.face_twice && over(tally.curves, 1)) allowed_[c] = 0;
    if (rules_.some_edge && !over(tally.curves, 0)) allowed_[c] = 0;
  }
  if (rules_.one_arc_a_face)
    for (const CurvePair& pair : pairs_)
      if (curves_[pair.first].cluster == curves_[pair.second].cluster)
        allowed_[curves_[pair.first].cluster] = 0;
}

}  // namespace voxweld
