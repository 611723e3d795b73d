// What of BrickNodes goes through the solver, eight lanes at a time.
#include <optional>

#include "stages/build/brick_nodes.h"
#include "stages/build/cell_planes.h"
#include "stages/contouring/cluster_sum.h"

namespace voxweld {

// Finest cells, or sheets of them, on their way. Two streams: those that may collapse keep their
// QEF, and are solved only if they stay leaves; those that may not are solved at once.
class BrickNodes::CellBatches {
 public:
  CellBatches(BrickNodes& brick, const HermiteEdges& edges)
      : keep_(brick.parameters_), solve_(brick.parameters_), brick_(brick), edges_(edges) {
    keep_.clear_planes();
    solve_.clear_planes();
  }

  // sheet: of the cell, or all_sheets.
  void keep(std::size_t cell, int sheet) {
    NodeLevel& level = brick_.levels_[0];
    keep_cluster_[kept_] = static_cast<std::uint32_t>(level.clusters.size());
    SheetCluster& cluster = level.clusters.emplace_back();
    cluster.normals = gather(cell, sheet, keep_, kept_);
    cluster.first = LeafCode::make(level.codes[cell], 0, std::max(sheet, 0));
    cluster.collapses = true;
    if (++kept_ == lanes) flush_kept();
  }
  void solve(std::size_t cell, int sheet) {
    solve_sheet_[solved_] = static_cast<std::uint32_t>(brick_.sheets_.size());
    brick_.sheets_.push_back({{}, pack_clusters(gather(cell, sheet, solve_, solved_))});
    if (++solved_ == lanes) flush_solved();
  }
  void flush() {
    if (kept_ > 0) flush_kept();
    if (solved_ > 0) flush_solved();
  }

 private:
  // The planes to a lane of the solver.
  NormalClusters gather(std::size_t cell, int sheet, NodeSolver& solver, std::size_t lane) {
    const ActiveCells& cells = *brick_.cells_;
    gather_planes(cells.at(cell), cells.sheets(cell), sheet, edges_, brick_.parameters_.spacing,
                  planes_);
    if (solver.needs_centres())
      solver.set_centre(
          lane, node_centre(brick_.frame_, 0, cells.code(cell), brick_.parameters_.spacing));
    solver.set_planes(lane, planes_.planes.data(), planes_.count);
    return cluster_normals(planes_.normal_span(), cells.normal_sense(cell));
  }
  void flush_kept() {
    keep_.reduce();
    for (std::size_t i = 0; i < kept_; ++i)
      brick_.levels_[0].clusters[keep_cluster_[i]].qef = keep_.qef(i);
    kept_ = 0;
    keep_.clear_planes();
  }
  void flush_solved() {
    solve_.reduce();
    solve_.solve(0, solved_);
    for (std::size_t i = 0; i < solved_; ++i)
      brick_.sheets_[solve_sheet_[i]].solution = solve_.solution(i);
    solved_ = 0;
    solve_.clear_planes();
  }

  NodeSolver keep_, solve_;
  SheetPlanes planes_;
  BrickNodes& brick_;
  const HermiteEdges& edges_;
  std::array<std::uint32_t, lanes> keep_cluster_{}, solve_sheet_{};
  std::size_t kept_ = 0, solved_ = 0;
};

// Where each sheet is a cluster they take most of the memory: no more than they need.
void BrickNodes::reserve_sheets() {
  if (!by_sheets_) return;
  std::size_t sheets = 0;
  for (std::size_t i = 0; i < cells_->size(); ++i) sheets += cells_->sheets(i).sheets;
  levels_[0].clusters.reserve(sheets);
}

void BrickNodes::make_cells(const HermiteEdges& edges) {
  const ActiveCells& cells = *cells_;
  NodeLevel& level = levels_[0];
  level.codes = cells.codes();
  level.kinds.assign(cells.size(), NodeKind::blocked);
  level.closes.assign(cells.size(), 0);
  level.first_cluster.resize(cells.size() + 1);
  level.clusters.clear();
  reserve_sheets();
  first_sheet_.assign(cells.size(), no_cluster);
  sheets_.clear();
  CellBatches batches(*this, edges);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int sheets = cells.sheets(i).sheets;
    const bool collapses = cells.collapses(i);
    level.first_cluster[i] = static_cast<std::uint32_t>(level.clusters.size());
    if (parameters_.simplify.enabled && (collapses || free_ || by_sheets_)) {
      level.kinds[i] = (collapses || free_) && options_.signs ? NodeKind::simple : NodeKind::shaped;
      if (sheets == 1 || free_)
        batches.keep(i, all_sheets);
      else
        for (int sheet = 0; sheet < sheets; ++sheet) batches.keep(i, sheet);
      if (collapses || by_sheets_) continue;
    }
    first_sheet_[i] = static_cast<std::uint32_t>(sheets_.size());
    for (int sheet = 0; sheet < sheets; ++sheet) batches.solve(i, sheet);
  }
  batches.flush();
  level.first_cluster[cells.size()] = static_cast<std::uint32_t>(level.clusters.size());
}

// Clusters of one level on their way.
class BrickNodes::MergeBatch {
 public:
  // collapsing: solves them too, and says which are within the tolerance.
  MergeBatch(BrickNodes& brick, bool collapsing)
      : solver_(brick.parameters_),
        sum_(brick.parameters_),
        brick_(brick),
        collapsing_(collapsing) {
    solver_.clear_children();
  }

  void begin(int l) {
    l_ = l;
    at_ = &brick_.levels_[static_cast<std::size_t>(l)];
    below_ = &brick_.levels_[static_cast<std::size_t>(l) - 1];
  }
  void add(std::size_t node, std::uint32_t cluster) {
    if (solver_.needs_centres()) solver_.set_centre(count_, centre(l_, at_->codes[node]));
    nodes_[count_] = static_cast<std::uint32_t>(node);
    clusters_[count_] = cluster;
    if (at_->kinds[node] == NodeKind::simple)
      each_child(node, [&](int octant, const SheetCluster& part) {
        solver_.set_child(count_, octant, part.qef);
      });
    else
      add_up(node, cluster);
    if (++count_ == lanes) flush();
  }
  void flush() {
    if (count_ == 0) return;
    solver_.merge(l_ - 1);
    if (collapsing_) solver_.solve(l_, count_);
    for (std::size_t i = 0; i < count_; ++i) {
      SheetCluster& cluster = at_->clusters[clusters_[i]];
      cluster.qef = solver_.qef(i);
      if (collapsing_) {
        cluster.solution = solver_.solution(i);
        cluster.collapses = solver_.within_tolerance(cluster.solution);
      }
      // Of what has not collapsed nothing is made but by sheets.
      if (at_->kinds[nodes_[i]] == NodeKind::simple && (cluster.collapses || brick_.by_sheets_))
        cluster.normals = normals_of(nodes_[i]);
    }
    count_ = 0;
    solver_.clear_children();
  }

 private:
  Vec3 centre(int l, std::uint32_t code) const {
    return node_centre(brick_.frame_, l, code, brick_.parameters_.spacing);
  }
  // Of a simple node: a child has one cluster.
  template <class F>
  void each_child(std::size_t node, const F& f) const {
    for (std::uint32_t child = at_->first_child[node]; child < at_->first_child[node + 1]; ++child)
      f(static_cast<int>(below_->codes[child] & 7), below_->clusters[below_->first_cluster[child]]);
  }
  NormalClusters normals_of(std::size_t node) const {
    ClusterMerge normals;
    each_child(node, [&](int, const SheetCluster& part) { normals.add(part.normals); });
    return normals.merged();
  }
  void add_up(std::size_t node, std::uint32_t cluster) {
    sum_.begin(solver_, count_);
    for (std::uint32_t child = at_->first_child[node]; child < at_->first_child[node + 1]; ++child)
      for (std::uint32_t i = below_->first_cluster[child]; i < below_->first_cluster[child + 1];
           ++i) {
        const SheetCluster& part = below_->clusters[i];
        if (part.parent == cluster)
          sum_.add(static_cast<int>(below_->codes[child] & 7), part.qef, part.normals,
                   solver_.needs_centres() ? centre(l_ - 1, below_->codes[child]) : Vec3{});
      }
    at_->clusters[cluster].normals = sum_.finish();
  }

  NodeSolver solver_;
  ClusterSum sum_;
  BrickNodes& brick_;
  NodeLevel* at_ = nullptr;
  const NodeLevel* below_ = nullptr;
  std::array<std::uint32_t, lanes> nodes_{}, clusters_{};
  std::size_t count_ = 0;
  int l_ = 0;
  bool collapsing_;
};

void BrickNodes::make_nodes() {
  MergeBatch collapsing(*this, true);
  std::optional<MergeBatch> others;
  if (by_sheets_) others.emplace(*this, false);
  for (int l = 1; l <= frame_.level; ++l) {
    make_level(l);
    const NodeLevel& at = level(l);
    collapsing.begin(l);
    if (others) others->begin(l);
    for (std::size_t node = 0; node < at.codes.size(); ++node)
      for (std::uint32_t i = at.first_cluster[node]; i < at.first_cluster[node + 1]; ++i)
        (at.clusters[i].collapses ? collapsing : *others).add(node, i);
    collapsing.flush();
    if (others) others->flush();
  }
}

}  // namespace voxweld
