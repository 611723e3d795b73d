// What of BrickNodes goes through the solver, eight lanes at a time.
#include <optional>

#include "stages/build/brick_nodes.h"
#include "stages/build/cell_planes.h"
#include "stages/contouring/cluster_sum.h"

namespace voxweld {

// Finest cells, or sheets of them, on their way. Three streams: those that may collapse keep their
// QEF, till their block is done; those that nothing in it has taken in are solved then; and those
// that may not collapse are solved at once.
class BrickNodes::CellBatches {
 public:
  CellBatches(BrickNodes& brick, const HermiteEdges& edges)
      : keep_(brick.parameters_),
        settle_{NodeSolver(brick.parameters_), {}},
        solve_{NodeSolver(brick.parameters_), {}},
        brick_(brick),
        edges_(edges) {
    keep_.clear_planes();
    solve_.solver.clear_planes();
  }

  // sheet: of the cell, or all_sheets.
  void keep(std::size_t cell, int sheet) {
    NodeLevel& level = brick_.levels_[0];
    SheetCluster& cluster = level.clusters.emplace_back();
    cluster.first = LeafCode::make(level.codes[cell], 0, std::max(sheet, 0));
    cluster.collapses = true;
    brick_.own_sheet_.push_back(no_cluster);
    level.vertices.push_back({gather(cell, sheet, keep_, kept_), {}});
    if (++kept_ == lanes) flush_kept();
  }
  void flush_kept() {
    if (kept_ == 0) return;
    keep_.reduce();
    for (std::size_t i = 0; i < kept_; ++i) brick_.levels_[0].qefs.push_back(keep_.qef(i));
    kept_ = 0;
    keep_.clear_planes();
  }
  void solve(std::size_t cell, int sheet) {
    NodeSolver& solver = solve_.solver;
    const NormalClusters normals = gather(cell, sheet, solver, solve_.count);
    if (!add_sheet(solve_, normals)) return;
    solver.reduce();
    finish(solve_);
    solver.clear_planes();
  }
  // A finest cluster of the block.
  void settle(std::size_t cell, std::size_t cluster) {
    const NodeLevel& level = brick_.levels_[0];
    set_centre(settle_.solver, settle_.count, cell);
    settle_.solver.load(settle_.count, level.qef(cluster));
    brick_.own_sheet_[cluster] = static_cast<std::uint32_t>(brick_.sheets_.size());
    if (add_sheet(settle_, level.vertex(cluster).normals)) finish(settle_);
  }
  void flush_sheets() {
    solve_.solver.reduce();
    finish(solve_);
    finish(settle_);
  }

 private:
  // Of sheets_ to be solved.
  struct SheetBatch {
    NodeSolver solver;
    std::array<std::uint32_t, lanes> sheet{};
    std::size_t count = 0;
  };

  void set_centre(NodeSolver& solver, std::size_t lane, std::size_t cell) const {
    if (solver.needs_centres())
      solver.set_centre(lane, node_centre(brick_.frame_, 0, brick_.cells_->code(cell),
                                          brick_.parameters_.spacing));
  }
  // The planes to a lane of the solver.
  NormalClusters gather(std::size_t cell, int sheet, NodeSolver& solver, std::size_t lane) {
    const ActiveCells& cells = *brick_.cells_;
    gather_planes(cells.at(cell), cells.sheets(cell), sheet, edges_, brick_.parameters_.spacing,
                  planes_);
    set_centre(solver, lane, cell);
    solver.set_planes(lane, planes_.planes.data(), planes_.count);
    return cluster_normals(planes_.normal_span(), cells.normal_sense(cell));
  }
  // Whether the batch is full with it.
  bool add_sheet(SheetBatch& batch, const NormalClusters& normals) {
    batch.sheet[batch.count] = static_cast<std::uint32_t>(brick_.sheets_.size());
    brick_.sheets_.push_back({{}, pack_clusters(normals)});
    return ++batch.count == lanes;
  }
  void finish(SheetBatch& batch) {
    batch.solver.solve(0, batch.count);
    for (std::size_t i = 0; i < batch.count; ++i)
      brick_.sheets_[batch.sheet[i]].solution = batch.solver.solution(i);
    batch.count = 0;
  }

  NodeSolver keep_;
  SheetBatch settle_, solve_;
  SheetPlanes planes_;
  BrickNodes& brick_;
  const HermiteEdges& edges_;
  std::size_t kept_ = 0;
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

// The cells of one block.
void BrickNodes::make_cells(Range range, CellBatches& batches) {
  const ActiveCells& cells = *cells_;
  NodeLevel& level = levels_[0];
  level.first_vertex = level.first_qef = static_cast<std::uint32_t>(level.clusters.size());
  level.vertices.clear();
  level.qefs.clear();
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const int sheets = cells.sheets(i).sheets;
    const bool collapses = cells.collapses(i);
    if (parameters_.simplify.enabled && (collapses || free_ || by_sheets_)) {
      level.kinds[i] = (collapses || free_) && options_.signs ? NodeKind::simple : NodeKind::shaped;
      if (sheets == 1 || free_)
        batches.keep(i, all_sheets);
      else
        for (int sheet = 0; sheet < sheets; ++sheet) batches.keep(i, sheet);
    }
    level.first_cluster[i + 1] = static_cast<std::uint32_t>(level.clusters.size());
    if (level.kinds[i] != NodeKind::blocked && (collapses || by_sheets_)) continue;
    first_sheet_[i] = static_cast<std::uint32_t>(sheets_.size());
    for (int sheet = 0; sheet < sheets; ++sheet) batches.solve(i, sheet);
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
  explicit NodeMerges(BrickNodes& brick) : brick_(brick), collapsing_(brick, true) {
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
    for (std::size_t node = nodes.begin; node < nodes.end; ++node)
      for (std::uint32_t i = at.first_cluster[node]; i < at.first_cluster[node + 1]; ++i)
        (at.clusters[i].collapses ? collapsing_ : *others_).add(node, i);
    collapsing_.flush();
    if (others_) others_->flush();
  }

 private:
  BrickNodes& brick_;
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
      merges.merge(l, nodes);
    }
    settle_cells(block, batches);
  }
  batches.flush_sheets();
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
  NodeMerges merges(*this);
  make_blocks(edges, merges);
  for (int l = block_top() + 1; l <= frame_.level; ++l)
    merges.merge(l, make_level(l, {0, level(l - 1).codes.size()}));
}

}  // namespace voxweld
