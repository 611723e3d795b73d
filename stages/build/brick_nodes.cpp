// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, sections 3.1
// and 4. Where it differs: bottom-up over linear levels, eight nodes at a time; cells with several
// sheets (Nielson, "Dual Marching Cubes", 2004) never take part in a safe collapse.
#include "stages/build/brick_nodes.h"

#include "stages/build/cell_planes.h"

namespace voxweld {
namespace {

// "free" may collapse what no sign test allows, up to the smallest brick: polygons are then decided
// edge by edge inside one brick (brick_polygons.cpp), the same for every brick size.
int highest_collapse(const BrickFrame& frame, const SimplifyParameters& simplify) {
  if (!simplify.enabled) return 0;
  const int highest = std::min(frame.level, frame.domain_level);
  return simplify.topology == Topology::free ? std::min(highest, min_brick_level) : highest;
}

// Eight finest cells (or sheets) on their way through the solver.
class CellBatch {
 public:
  CellBatch(const ContourParameters& parameters, const BrickFrame& frame)
      : spacing_(parameters.spacing), frame_(frame), solver_(parameters) {
    solver_.clear_planes();
  }
  bool full() const { return count_ == lanes; }
  std::size_t count() const { return count_; }

  // Adds the planes and says which lane took them.
  std::size_t add(std::uint32_t code, const SheetPlanes& planes) {
    if (solver_.needs_centres()) solver_.set_centre(count_, node_centre(frame_, 0, code, spacing_));
    solver_.set_planes(count_, planes.planes.data(), planes.count);
    return count_++;
  }
  NodeSolver& reduce() {
    solver_.reduce();
    return solver_;
  }
  void clear() {
    count_ = 0;
    solver_.clear_planes();
  }

 private:
  Vec3 spacing_;
  const BrickFrame& frame_;
  NodeSolver solver_;
  std::size_t count_ = 0;
};

}  // namespace

void BrickNodes::simplify(const BrickFrame& frame, const CollapseRule& rule,
                          const ActiveCells& cells, const HermiteEdges& edges,
                          const ContourParameters& parameters) {
  levels_.resize(static_cast<std::size_t>(frame.level) + 1);
  make_cells(frame, cells, edges, parameters);
  const int highest = highest_collapse(frame, parameters.simplify);
  for (int l = 1; l <= frame.level; ++l) {
    make_level(l);
    if (l <= highest) collapse_level(l, frame, rule, parameters);
  }
}

void BrickNodes::make_cells(const BrickFrame& frame, const ActiveCells& cells,
                            const HermiteEdges& edges, const ContourParameters& parameters) {
  NodeLevel& level = levels_[0];
  level.codes = cells.codes();
  level.leaf.assign(cells.size(), no_leaf);
  level.leaves.clear();
  first_sheet_.assign(cells.size(), no_leaf);
  sheets_.clear();
  const bool simplify = parameters.simplify.enabled;
  const bool free = parameters.simplify.topology == Topology::free;

  // Two streams of batches: cells that may collapse keep their QEF (and are solved only if they
  // stay leaves); sheets that may not are solved at once.
  CellBatch keep(parameters, frame), solve(parameters, frame);
  std::array<std::uint32_t, lanes> keep_leaf{}, solve_sheet{};
  const auto flush_keep = [&] {
    if (keep.count() == 0) return;
    const NodeSolver& solver = keep.reduce();
    for (std::size_t i = 0; i < keep.count(); ++i) level.leaves[keep_leaf[i]].qef = solver.qef(i);
    keep.clear();
  };
  const auto flush_solve = [&] {
    if (solve.count() == 0) return;
    NodeSolver& solver = solve.reduce();
    solver.solve(0, solve.count());
    for (std::size_t i = 0; i < solve.count(); ++i)
      sheets_[solve_sheet[i]].solution = solver.solution(i);
    solve.clear();
  };

  SheetPlanes planes;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const LocalCell c = cells.at(i);
    const CellSheets& sheets = cells.sheets(i);
    const bool may_collapse = cells.collapses(i);
    const NormalSense sense = cells.normal_sense(i);
    if (simplify && (may_collapse || free)) {
      gather_planes(c, sheets, all_sheets, edges, parameters.spacing, planes);
      level.leaf[i] = static_cast<std::uint32_t>(level.leaves.size());
      level.leaves.emplace_back();
      level.leaves.back().clusters = cluster_normals(planes.normal_span(), sense);
      keep_leaf[keep.add(cells.code(i), planes)] = level.leaf[i];
      if (keep.full()) flush_keep();
      if (may_collapse) continue;
    }
    first_sheet_[i] = static_cast<std::uint32_t>(sheets_.size());
    for (int sheet = 0; sheet < sheets.sheets; ++sheet) {
      gather_planes(c, sheets, sheet, edges, parameters.spacing, planes);
      const auto index = static_cast<std::uint32_t>(sheets_.size());
      sheets_.push_back({{}, pack_clusters(cluster_normals(planes.normal_span(), sense))});
      solve_sheet[solve.add(cells.code(i), planes)] = index;
      if (solve.full()) flush_solve();
    }
  }
  flush_keep();
  flush_solve();
}

void BrickNodes::make_level(int l) {
  const NodeLevel& below = levels_[static_cast<std::size_t>(l) - 1];
  NodeLevel& level = levels_[static_cast<std::size_t>(l)];
  level.codes.clear();
  level.first_child.clear();
  level.leaves.clear();
  for (std::size_t i = 0; i < below.codes.size(); ++i) {
    const std::uint32_t parent = below.codes[i] >> 3;
    if (!level.codes.empty() && level.codes.back() == parent) continue;
    level.codes.push_back(parent);
    level.first_child.push_back(static_cast<std::uint32_t>(i));
  }
  level.first_child.push_back(static_cast<std::uint32_t>(below.codes.size()));
  level.leaf.assign(level.codes.size(), no_leaf);
}

bool BrickNodes::children_are_leaves(int l, std::size_t node) const {
  const NodeLevel& below = level(l - 1);
  const std::uint32_t end = level(l).first_child[node + 1];
  for (std::uint32_t child = level(l).first_child[node]; child < end; ++child)
    if (below.leaf[child] == no_leaf) return false;
  return true;
}

void BrickNodes::collapse_level(int l, const BrickFrame& frame, const CollapseRule& rule,
                                const ContourParameters& parameters) {
  const NodeLevel& level = levels_[static_cast<std::size_t>(l)];
  const bool free = parameters.simplify.topology == Topology::free;
  candidates_.clear();
  for (std::size_t node = 0; node < level.codes.size(); ++node) {
    if (!children_are_leaves(l, node)) continue;
    const LocalCell c = decode_local(level.codes[node] << (3 * l));
    if (free || rule.allows(c.x, c.y, c.z, 1 << l))
      candidates_.push_back(static_cast<std::uint32_t>(node));
  }
  NodeSolver solver(parameters);
  for (std::size_t begin = 0; begin < candidates_.size(); begin += lanes) {
    const std::size_t end = std::min(begin + lanes, candidates_.size());
    for (std::size_t i = begin; i < end && solver.needs_centres(); ++i)
      solver.set_centre(i - begin,
                        node_centre(frame, l, level.codes[candidates_[i]], parameters.spacing));
    collapse_batch(l, candidates_, begin, end, solver);
  }
}

void BrickNodes::collapse_batch(int l, const std::vector<std::uint32_t>& nodes, std::size_t begin,
                                std::size_t end, NodeSolver& solver) {
  NodeLevel& level = levels_[static_cast<std::size_t>(l)];
  const NodeLevel& below = levels_[static_cast<std::size_t>(l) - 1];
  const auto each_child = [&](std::uint32_t node, auto&& f) {
    for (std::uint32_t child = level.first_child[node]; child < level.first_child[node + 1];
         ++child)
      f(static_cast<int>(below.codes[child] & 7), below.leaves[below.leaf[child]]);
  };
  solver.clear_children();
  for (std::size_t i = begin; i < end; ++i)
    each_child(nodes[i], [&](int octant, const LeafData& leaf) {
      solver.set_child(i - begin, octant, leaf.qef);
    });
  solver.merge(l - 1);
  solver.solve(l, end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    const NodeSolution solution = solver.solution(i - begin);
    if (!solver.within_tolerance(solution)) continue;
    ClusterMerge clusters;
    each_child(nodes[i], [&](int, const LeafData& leaf) { clusters.add(leaf.clusters); });
    level.leaf[nodes[i]] = static_cast<std::uint32_t>(level.leaves.size());
    level.leaves.push_back({solver.qef(i - begin), clusters.merged(), solution});
  }
}

}  // namespace voxweld
