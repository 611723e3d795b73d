// What of BrickNodes goes through the solver, eight lanes at a time.
#include <optional>

#include "stages/build/brick_nodes.h"
#include "stages/build/cell_planes.h"
#include "stages/build/plane_merges.h"
#include "stages/contouring/cluster_sum.h"

namespace voxweld {

// Finest cells, or sheets of them, on their way: for those that a node above adds up the QEF, and for
// those that stay their vertex.
class BrickNodes::CellBatches {
 public:
  CellBatches(BrickNodes& brick, const HermiteEdges& edges)
      : keep_(brick.parameters_), solve_(brick.parameters_), brick_(brick), edges_(edges) {
    keep_.clear_planes();
    solve_.clear_planes();
  }

  // Of a cell that may collapse: its clusters' QEFs and normals.
  void keep(std::size_t cell) {
    const NodeLevel& level = brick_.level(0);
    const std::uint32_t begin = level.first_cluster[cell], end = level.first_cluster[cell + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      brick_.levels_[0].vertex(i).normals = gather(cell, sheet_of(cell, i), keep_, kept_count_);
      kept_[kept_count_] = i;
      if (++kept_count_ == lanes) flush_kept();
    }
  }
  void flush_kept() {
    if (kept_count_ == 0) return;
    keep_.reduce();
    for (std::size_t i = 0; i < kept_count_; ++i) brick_.levels_[0].qef(kept_[i]) = keep_.qef(i);
    kept_count_ = 0;
    keep_.clear_planes();
  }
  // sheet: of the cell, or all_sheets.
  void solve(std::size_t cell, int sheet) {
    const NormalClusters normals = gather(cell, sheet, solve_, solved_count_);
    solved_[solved_count_] = static_cast<std::uint32_t>(brick_.sheets_.size());
    brick_.sheets_.push_back({{}, pack_clusters(normals)});
    if (++solved_count_ == lanes) flush_solved();
  }
  // A finest cluster that nothing has taken in.
  void settle(std::size_t cell, std::uint32_t cluster) {
    brick_.own_sheet_[cluster] = static_cast<std::uint32_t>(brick_.sheets_.size());
    solve(cell, sheet_of(cell, cluster));
  }
  void flush_solved() {
    if (solved_count_ == 0) return;
    solve_.reduce();
    solve_.solve(0, solved_count_);
    for (std::size_t i = 0; i < solved_count_; ++i)
      brick_.sheets_[solved_[i]].solution = solve_.solution(i);
    solved_count_ = 0;
    solve_.clear_planes();
  }

 private:
  int sheet_of(std::size_t cell, std::uint32_t cluster) const {
    const NodeLevel& level = brick_.level(0);
    const std::uint32_t begin = level.first_cluster[cell];
    if (level.first_cluster[cell + 1] - begin == 1) return all_sheets;
    return static_cast<int>(cluster - begin);
  }
  // The planes to a lane of the solver.
  NormalClusters gather(std::size_t cell, int sheet, NodeSolver& solver, std::size_t lane) {
    const ActiveCells& cells = *brick_.cells_;
    gather_planes(cells.at(cell), cells.sheets(cell), sheet, edges_, brick_.parameters_.spacing,
                  planes_);
    if (solver.needs_centres())
      solver.set_centre(
          lane, node_centre(brick_.frame_, 0, cells.code(cell), brick_.parameters_.spacing));
    solver.set_planes(lane, planes_.planes());
    return cluster_normals(planes_.normals(), cells.normal_sense(cell));
  }

  NodeSolver keep_, solve_;
  SheetPlanes planes_;
  BrickNodes& brick_;
  const HermiteEdges& edges_;
  std::array<std::uint32_t, lanes> kept_{}, solved_{};  // finest clusters; of sheets_
  std::size_t kept_count_ = 0, solved_count_ = 0;
};

// Where each sheet is a cluster they take much of the memory: no more than they need.
void BrickNodes::reserve_sheets() {
  if (!by_sheets_) return;
  std::size_t sheets = 0, before_block = 0, most_of_block = 0;
  for (std::size_t i = 0; i < cells_->size(); ++i) {
    if (i > 0 && (cells_->code(i) ^ cells_->code(i - 1)) >> (3 * block_level) != 0)
      before_block = sheets;
    sheets += cells_->sheets(i).sheets;
    most_of_block = std::max(most_of_block, sheets - before_block);
  }
  levels_[0].clusters.reserve(sheets);
  own_sheet_.reserve(sheets);
  levels_[0].vertices.reserve(most_of_block);
  levels_[0].qefs.reserve(most_of_block);
}

// The cells of one block. Nothing is known of their clusters but which they are, until asked for.
void BrickNodes::make_cells(Range range, CellBatches& batches) {
  const ActiveCells& cells = *cells_;
  NodeLevel& level = levels_[0];
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const int sheets = cells.sheets(i).sheets;
    const bool collapses = cells.collapses(i);
    if (parameters_.simplify.enabled && (collapses || free_ || by_sheets_)) {
      level.kinds[i] = (collapses || free_) && options_.signs ? NodeKind::simple : NodeKind::shaped;
      for (int sheet = 0; sheet < (free_ ? 1 : sheets); ++sheet)
        level.clusters.push_back({no_cluster, LeafCode::make(level.codes[i], 0, sheet), true});
    }
    level.first_cluster[i + 1] = static_cast<std::uint32_t>(level.clusters.size());
    if (level.kinds[i] != NodeKind::blocked && (collapses || by_sheets_)) continue;
    first_sheet_[i] = static_cast<std::uint32_t>(sheets_.size());
    for (int sheet = 0; sheet < sheets; ++sheet) batches.solve(i, sheet);
  }
  const std::uint32_t first = level.first_cluster[range.begin];
  level.first_vertex = level.first_qef = first;
  const std::size_t count = level.clusters.size() - first;
  if (level.vertices.size() < count) level.vertices.resize(count);
  if (level.qefs.size() < count) level.qefs.resize(count);
  own_sheet_.resize(level.clusters.size(), no_cluster);
}

// Whether the planes of its edges are made its QEF at once, not those of its cells added up: where
// it has one cluster, which all its edges are of.
bool BrickNodes::is_of_planes(std::size_t node) const {
  const NodeLevel& at = level(1);
  return at.kinds[node] != NodeKind::blocked && is_one(1, node) &&
         at.clusters[at.first_cluster[node]].collapses;
}

// Of the cells of nodes that add them up.
void BrickNodes::keep_cells(Range nodes, CellBatches& batches) {
  const NodeLevel& at = level(1);
  for (std::size_t node = nodes.begin; node < nodes.end; ++node) {
    if (at.kinds[node] == NodeKind::blocked || is_of_planes(node)) continue;
    for (std::uint32_t cell = at.first_child[node]; cell < at.first_child[node + 1]; ++cell)
      batches.keep(cell);
  }
  batches.flush_kept();
}

// Whether a cluster of its block has.
bool BrickNodes::is_taken_in(std::size_t finest) const {
  std::uint32_t parent = level(0).clusters[finest].parent;
  for (int l = 1; l <= block_top() && parent != no_cluster; ++l) {
    const SheetCluster& cluster = level(l).clusters[parent];
    if (cluster.collapses) return true;
    parent = cluster.parent;
  }
  return false;
}

void BrickNodes::settle_cells(Range range, CellBatches& batches) {
  const NodeLevel& level = levels_[0];
  for (std::size_t cell = range.begin; cell < range.end; ++cell) {
    if (first_sheet_[cell] != no_cluster) continue;
    for (std::uint32_t i = level.first_cluster[cell]; i < level.first_cluster[cell + 1]; ++i)
      if (!is_taken_in(i)) batches.settle(cell, i);
  }
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
      each_child(node, [&](int octant, std::uint32_t part) {
        solver_.set_child(count_, octant, below_->qef(part));
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
      ClusterVertex& vertex = at_->vertex(clusters_[i]);
      at_->qef(clusters_[i]) = solver_.qef(i);
      if (collapsing_) {
        vertex.solution = solver_.solution(i);
        cluster.collapses = solver_.within_tolerance(vertex.solution);
      }
      // Of what has not collapsed nothing is made but by sheets.
      if (at_->kinds[nodes_[i]] == NodeKind::simple && (cluster.collapses || brick_.by_sheets_))
        vertex.normals = normals_of(nodes_[i]);
    }
    count_ = 0;
    solver_.clear_children();
  }

 private:
  Vec3 centre(int l, std::uint32_t code) const {
    return node_centre(brick_.frame_, l, code, brick_.parameters_.spacing);
  }
  // f(octant, its cluster), of a simple node: a child has one.
  template <class F>
  void each_child(std::size_t node, const F& f) const {
    for (std::uint32_t child = at_->first_child[node]; child < at_->first_child[node + 1]; ++child)
      f(static_cast<int>(below_->codes[child] & 7), below_->first_cluster[child]);
  }
  NormalClusters normals_of(std::size_t node) const {
    ClusterMerge normals;
    each_child(node, [&](int, std::uint32_t part) { normals.add(below_->vertex(part).normals); });
    return normals.merged();
  }
  void add_up(std::size_t node, std::uint32_t cluster) {
    sum_.begin(solver_, count_);
    for (std::uint32_t child = at_->first_child[node]; child < at_->first_child[node + 1]; ++child)
      for (std::uint32_t i = below_->first_cluster[child]; i < below_->first_cluster[child + 1];
           ++i)
        if (below_->clusters[i].parent == cluster)
          sum_.add(static_cast<int>(below_->codes[child] & 7), below_->qef(i),
                   below_->vertex(i).normals,
                   solver_.needs_centres() ? centre(l_ - 1, below_->codes[child]) : Vec3{});
    at_->vertex(cluster).normals = sum_.finish();
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

// All clusters of nodes that were made.
class BrickNodes::NodeMerges {
 public:
  NodeMerges(BrickNodes& brick, const HermiteEdges& edges)
      : brick_(brick), of_planes_(brick, edges), collapsing_(brick, true) {
    if (brick.by_sheets_) others_.emplace(brick, false);
  }

  void merge(int l, Range nodes) {
    NodeLevel& at = brick_.levels_[static_cast<std::size_t>(l)];
    if (l < brick_.block_top()) {
      at.first_qef = at.first_cluster[nodes.begin];
      at.qefs.clear();
    }
    at.vertices.resize(at.clusters.size());
    at.qefs.resize(at.clusters.size() - at.first_qef);
    collapsing_.begin(l);
    if (others_) others_->begin(l);
    for (std::size_t node = nodes.begin; node < nodes.end; ++node) {
      if (l == 1 && brick_.is_of_planes(node)) {
        of_planes_.add(node);
        continue;
      }
      for (std::uint32_t i = at.first_cluster[node]; i < at.first_cluster[node + 1]; ++i)
        (at.clusters[i].collapses ? collapsing_ : *others_).add(node, i);
    }
    of_planes_.flush();
    collapsing_.flush();
    if (others_) others_->flush();
  }

 private:
  BrickNodes& brick_;
  PlaneMerges of_planes_;
  MergeBatch collapsing_;
  std::optional<MergeBatch> others_;
};

void BrickNodes::make_blocks(const HermiteEdges& edges, NodeMerges& merges) {
  const std::vector<std::uint32_t>& codes = level(0).codes;
  CellBatches batches(*this, edges);
  for (Range block; block.begin < codes.size(); block.begin = block.end) {
    const std::uint32_t code = codes[block.begin] >> (3 * block_level);
    while (block.end < codes.size() && codes[block.end] >> (3 * block_level) == code) ++block.end;
    make_cells(block, batches);
    Range nodes = block;
    for (int l = 1; l <= block_top(); ++l) {
      nodes = make_level(l, nodes);
      if (l == 1) keep_cells(nodes, batches);
      merges.merge(l, nodes);
    }
    settle_cells(block, batches);
  }
  batches.flush_solved();
}

void BrickNodes::make_nodes(const HermiteEdges& edges) {
  const ActiveCells& cells = *cells_;
  NodeLevel& finest = levels_[0];
  finest.codes = cells.codes();
  finest.kinds.assign(cells.size(), NodeKind::blocked);
  finest.closes.assign(cells.size(), 0);
  finest.first_cluster.resize(cells.size() + 1);
  first_sheet_.assign(cells.size(), no_cluster);
  own_sheet_.clear();
  reserve_sheets();
  sheets_.clear();
  NodeMerges merges(*this, edges);
  make_blocks(edges, merges);
  for (int l = block_top() + 1; l <= frame_.level; ++l)
    merges.merge(l, make_level(l, {0, level(l - 1).codes.size()}));
}

}  // namespace voxweld
