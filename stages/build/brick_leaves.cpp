#include "stages/build/brick_leaves.h"

#include <algorithm>
#include <numeric>

#include "stages/build/cell_planes.h"

namespace voxweld {

void BrickLeaves::collect(const BrickFrame& frame, const ActiveCells& cells, BrickNodes& nodes,
                          BrickOctree& out) {
  cells_ = &cells;
  nodes_ = &nodes;
  out_ = &out;
  apart_.clear();
  final_ = {};
  first_vertex_.resize(cells.size());
  root_clusters_.resize(static_cast<std::size_t>(frame.level) + 1);
  vertices_.resize(static_cast<std::size_t>(frame.level) + 1);
  kept_.resize(static_cast<std::size_t>(frame.level) + 1);
  for (int l = nodes.by_sheets() ? 0 : 1; l <= frame.level; ++l)
    vertices_[static_cast<std::size_t>(l)].assign(nodes.level(l).clusters.size(), no_cluster);
  if (nodes.by_sheets()) {
    begin_record(frame, nodes);
    find_roots(frame.level);
  }
  for (std::size_t node = 0; node < nodes.level(frame.level).codes.size(); ++node)
    visit(frame.level, node, false);
  if (nodes.by_sheets()) count_blocks(frame);
  out.counts.vertices = nodes.by_sheets() ? std::accumulate(final_.leaves.begin(),
                                                            final_.leaves.end(), std::uint64_t{0})
                                          : out.vertices.size();
  out.counts.by_level = final_;
}

// All but the counts of its clusters.
void BrickLeaves::begin_record(const BrickFrame& frame, BrickNodes& nodes) {
  const NodeLevel& top = nodes.level(frame.level);
  out_->record.blocked = top.kinds[0] == NodeKind::blocked;
  out_->record.closes = top.closes[0] != 0;
  if (out_->record.blocked) return;
  const NodeShape shape = nodes.root_shape();
  out_->record.curves.assign(shape.curves.begin(), shape.curves.end());
  out_->record.pairs.assign(shape.pairs.begin(), shape.pairs.end());
  const Index3 origin = frame.origin;
  for (std::size_t i = 0; i < top.clusters.size(); ++i) {
    const SheetCluster& cluster = top.clusters[i];
    const ClusterVertex& vertex = top.vertex(i);
    out_->record.clusters.push_back(
        {top.qef(i),
         vertex.normals,
         vertex.solution.offset,
         vertex.solution.residual,
         FirstSheet::make(morton_encode(origin) + cluster.first.code(), cluster.first.sheet()),
         shape.euler[i],
         cluster.collapses ? 1u : 0u,
         {}});
  }
}

void BrickLeaves::find_roots(int top) {
  for (int l = top; l > 0; --l) {
    const NodeLevel& level = nodes_->level(l);
    std::vector<std::uint32_t>& roots = root_clusters_[static_cast<std::size_t>(l)];
    roots.resize(level.clusters.size());
    kept_[static_cast<std::size_t>(l)].resize(level.clusters.size());
    for (std::size_t i = 0; i < roots.size(); ++i)
      roots[i] = l == top ? static_cast<std::uint32_t>(i) : root_of(l, i);
  }
}

// Of a cluster below the top.
std::uint32_t BrickLeaves::root_of(int l, std::size_t cluster) const {
  const std::uint32_t parent = nodes_->level(l).clusters[cluster].parent;
  return parent == no_cluster ? no_cluster
                              : root_clusters_[static_cast<std::size_t>(l) + 1][parent];
}

// The vertex of the cluster above that has taken it in.
std::uint32_t BrickLeaves::inherited(int l, std::size_t cluster) const {
  const std::uint32_t parent = nodes_->level(l).clusters[cluster].parent;
  return parent == no_cluster ? no_cluster : vertices_[static_cast<std::size_t>(l) + 1][parent];
}

// The next cluster above that is kept.
std::uint32_t BrickLeaves::kept_above(int l, std::size_t cluster) const {
  const std::uint32_t parent = nodes_->level(l).clusters[cluster].parent;
  return parent == no_cluster ? BrickLevels::none : kept_[static_cast<std::size_t>(l) + 1][parent];
}

// Of a cluster above all vertices: itself where its error is below all above, else what is kept
// above.
std::uint32_t BrickLeaves::keep(int l, std::size_t number, bool is_one) {
  const SheetCluster& cluster = nodes_->level(l).clusters[number];
  const ClusterVertex& vertex = nodes_->level(l).vertex(number);
  const std::uint32_t above = kept_above(l, number);
  std::vector<KeptCluster>& kept = out_->levels.clusters;
  if (!may_collapse(nodes_->level(l), number)) return above;
  if (above != BrickLevels::none && vertex.solution.residual >= kept[above].error) return above;
  const LeafCode leaf = LeafCode::make(cluster.first.code(), l, cluster.first.sheet());
  kept.push_back({{leaf.sharing(!is_one).with(vertex.normals.sense), vertex.solution.offset,
                   pack_clusters(vertex.normals)},
                  vertex.solution.residual,
                  above});
  return static_cast<std::uint32_t>(kept.size() - 1);
}

// covered: a vertex of a node above lies in this node's cube, or may.
void BrickLeaves::visit(int l, std::size_t node, bool covered) {
  if (l == 0) return add_cell(node, covered);
  const NodeLevel& level = nodes_->level(l);
  std::vector<std::uint32_t>& vertices = vertices_[static_cast<std::size_t>(l)];
  const bool is_one = nodes_->is_one(l, node), shares = covered || !is_one;
  for (std::uint32_t i = level.first_cluster[node]; i < level.first_cluster[node + 1]; ++i) {
    vertices[i] = inherited(l, i);
    if (!level.clusters[i].collapses) {
      if (nodes_->by_sheets() && vertices[i] == no_cluster)
        kept_[static_cast<std::size_t>(l)][i] = keep(l, i, is_one);
      continue;
    }
    covered = true;
    if (vertices[i] != no_cluster) continue;
    vertices[i] = static_cast<std::uint32_t>(out_->vertices.size());
    add_cluster(l, i, shares);
  }
  if (level.kinds[node] == NodeKind::simple) {
    const std::uint32_t vertex = vertices[level.first_cluster[node]];
    if (vertex != no_cluster) return take_in_cells(l, node, vertex);
  }
  for (std::uint32_t child = level.first_child[node]; child < level.first_child[node + 1]; ++child)
    visit(l - 1, child, covered);
}

// All that is below a simple node, which lies together.
void BrickLeaves::take_in_cells(int l, std::size_t node, std::uint32_t vertex) {
  std::size_t begin = node, end = node + 1;
  for (int below = l; below > 0; --below) {
    begin = nodes_->level(below).first_child[begin];
    end = nodes_->level(below).first_child[end];
  }
  std::fill(first_vertex_.begin() + static_cast<std::ptrdiff_t>(begin),
            first_vertex_.begin() + static_cast<std::ptrdiff_t>(end), vertex);
}

void BrickLeaves::add_cell(std::size_t cell, bool covered) {
  const std::uint32_t first_sheet = nodes_->first_sheet(cell);
  first_vertex_[cell] = static_cast<std::uint32_t>(out_->vertices.size());
  if (first_sheet != no_cluster) {
    const NormalSense sense = cells_->normal_sense(cell);
    for (int s = 0; s < cells_->sheets(cell).sheets; ++s) {
      const SheetVertex& sheet = nodes_->sheet(first_sheet + static_cast<std::size_t>(s));
      const LeafCode leaf = LeafCode::make(cells_->code(cell), 0, s).with(sense);
      add_vertex(leaf, sheet.solution, sheet.normals, final_);
    }
    return;
  }
  const NodeLevel& level = nodes_->level(0);
  const std::uint32_t begin = level.first_cluster[cell], end = level.first_cluster[cell + 1];
  const NormalSense sense = cells_->normal_sense(cell);
  if (!nodes_->by_sheets()) return add_finest(begin, sense, covered);
  for (std::uint32_t i = begin; i < end; ++i) {
    vertices_[0][i] = inherited(0, i);
    if (vertices_[0][i] != no_cluster) continue;
    vertices_[0][i] = static_cast<std::uint32_t>(out_->vertices.size());
    add_finest(i, sense, covered);
  }
  first_vertex_[cell] = vertices_[0][begin];
  if (end - begin == 1) return;
  first_vertex_[cell] = static_cast<std::uint32_t>(apart_.size()) | apart;
  apart_.insert(apart_.end(), vertices_[0].begin() + begin, vertices_[0].begin() + end);
}

LeafCounts& BrickLeaves::counts_of(std::uint8_t root) {
  return root == BrickOctree::no_root ? final_ : out_->record.clusters[root].leaves;
}

void BrickLeaves::add_cluster(int l, std::size_t number, bool shares) {
  const ClusterVertex& vertex = nodes_->level(l).vertex(number);
  add_of_cluster(l, number, shares,
                 {vertex.solution, pack_clusters(vertex.normals), vertex.normals.sense});
}

void BrickLeaves::add_finest(std::size_t number, NormalSense sense, bool shares) {
  const SheetVertex& sheet = nodes_->sheet(nodes_->own_sheet(number));
  add_of_cluster(0, number, shares, {sheet.solution, sheet.normals, sense});
}

void BrickLeaves::add_of_cluster(int l, std::size_t number, bool shares, const VertexValue& value) {
  const SheetCluster& cluster = nodes_->level(l).clusters[number];
  LeafCode leaf = LeafCode::make(cluster.first.code(), l, cluster.first.sheet());
  std::uint8_t root = BrickOctree::no_root;
  if (nodes_->by_sheets()) {
    const bool top = static_cast<std::size_t>(l) + 1 == root_clusters_.size();
    const std::uint32_t above = top ? static_cast<std::uint32_t>(number) : root_of(l, number);
    if (above != no_cluster) root = static_cast<std::uint8_t>(above);
    out_->roots.push_back(root);
    out_->levels.parents.push_back(top ? BrickLevels::none : kept_above(l, number));
    out_->levels.errors.push_back(value.solution.residual);
    leaf = leaf.sharing(shares);
  } else {
    // The node has no other: its lowest cell names it as well.
    leaf = LeafCode::make(cluster.first.code() >> (3 * l) << (3 * l), l, 0);
  }
  add_vertex(leaf.with(value.sense), value.solution, value.normals, counts_of(root));
}

void BrickLeaves::add_vertex(LeafCode leaf, const NodeSolution& solution,
                             const std::array<PackedNormal, max_clusters>& normals,
                             LeafCounts& counts) {
  out_->vertices.push_back({leaf, solution.offset, normals});
  if (!nodes_->by_sheets()) ++out_->blocks[leaf.code() >> (3 * block_level)].vertices;
  if (nodes_->by_sheets() || leaf.sheet() == 0)
    ++counts.leaves[static_cast<std::size_t>(leaf.level())];
  counts.note_error(leaf.level(), solution.residual);
}

// The vertices that blocks had if nothing above them had collapsed, and at which errors they would
// have fewer.
class BrickLeaves::BlockCounter {
 public:
  BlockCounter(const BrickNodes& nodes, BlockScratch& scratch, BrickOctree& out)
      : nodes_(nodes), s_(scratch), out_(out) {
    s_.at.clear();
    s_.candidates.clear();
  }

  void count(const BrickFrame& frame) {
    for (int l = std::min(block_level, frame.level); l >= 0; --l) {
      std::swap(s_.at, s_.above);
      const NodeLevel& level = nodes_.level(l);
      s_.at.assign(level.clusters.size(), none);
      for (std::size_t i = 0; i < level.clusters.size(); ++i) s_.at[i] = look_at(level, i, l);
    }
    for (const BlockScratch::Candidate& c : s_.candidates)
      if (c.parts > 1)
        out_.levels.merges.push_back(BlockMerge::make(c.error, c.block, c.parts - 1));
  }

 private:
  static constexpr std::uint32_t none = no_cluster, taken = no_cluster - 1;

  std::uint32_t above(const SheetCluster& cluster) const {
    return cluster.parent == no_cluster ? std::uint32_t{none} : s_.above[cluster.parent];
  }
  std::uint32_t look_at(const NodeLevel& level, std::size_t number, int l) {
    const SheetCluster& cluster = level.clusters[number];
    const std::uint32_t over = l < block_level ? above(cluster) : std::uint32_t{none};
    if (over == taken) return taken;
    const std::uint32_t block = cluster.first.code() >> (3 * block_level);
    if (cluster.collapses) {
      if (over != none) ++s_.candidates[over].parts;
      ++out_.blocks[block].vertices;
      return taken;
    }
    const float error = level.vertex(number).solution.residual;
    const bool lower = over == none || error < s_.candidates[over].error;
    if (!may_collapse(level, number) || !lower) return over;
    if (over != none) ++s_.candidates[over].parts;
    s_.candidates.push_back({error, block, 0});
    return static_cast<std::uint32_t>(s_.candidates.size() - 1);
  }

  const BrickNodes& nodes_;
  BlockScratch& s_;
  BrickOctree& out_;
};

void BrickLeaves::count_blocks(const BrickFrame& frame) {
  BlockCounter(*nodes_, blocks_, *out_).count(frame);
}

}  // namespace voxweld
