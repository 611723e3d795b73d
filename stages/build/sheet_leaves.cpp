#include "stages/build/sheet_leaves.h"

#include <algorithm>

#include "stages/build/cell_planes.h"

namespace voxweld {

void SheetLeaves::collect(const BrickFrame& frame, const ActiveCells& cells,
                          BrickClusters& clusters, const ContourParameters& parameters,
                          BrickOctree& out) {
  cells_ = &cells;
  clusters_ = &clusters;
  out_ = &out;
  finest_.clear();
  roots_.clear();
  final_ = {};
  begin_record(frame, clusters);
  find_roots(frame.level);
  vertices_.resize(static_cast<std::size_t>(frame.level) + 1);
  for (int l = 0; l <= frame.level; ++l)
    vertices_[static_cast<std::size_t>(l)].assign(clusters.level(l).clusters.size(), no_cluster);
  for (std::size_t node = 0; node < clusters.level(frame.level).codes.size(); ++node)
    visit(frame.level, node, false);
  solve_finest(frame, parameters);
  count_blocks(frame);
  out.counts.vertices = out.vertices.size();
  out.counts.leaves = final_.leaves;
  out.counts.worst_residual = final_.worst_residual;
  out.counts.worst_finest = final_.worst_finest;
}

// All but the counts of its clusters.
void SheetLeaves::begin_record(const BrickFrame& frame, BrickClusters& clusters) {
  record_ = {};
  const ClusterLevel& top = clusters.level(frame.level);
  record_.blocked = top.kinds[0] == NodeKind::blocked;
  record_.closes = top.closes[0] != 0;
  if (record_.blocked) return;
  const NodeShape shape = clusters.root_shape();
  record_.curves.assign(shape.curves.begin(), shape.curves.end());
  record_.pairs.assign(shape.pairs.begin(), shape.pairs.end());
  const Index3 origin = frame.origin;
  for (std::size_t i = 0; i < top.clusters.size(); ++i) {
    const SheetCluster& cluster = top.clusters[i];
    record_.clusters.push_back(
        {cluster.qef,
         cluster.normals,
         cluster.solution.offset,
         cluster.solution.residual,
         FirstSheet::make(morton_encode(origin) + cluster.first.code(), cluster.first.sheet()),
         shape.euler[i],
         cluster.collapses ? 1u : 0u,
         {}});
  }
}

void SheetLeaves::find_roots(int top) {
  root_clusters_.resize(static_cast<std::size_t>(top) + 1);
  for (int l = top; l > 0; --l) {
    const ClusterLevel& level = clusters_->level(l);
    std::vector<std::uint32_t>& roots = root_clusters_[static_cast<std::size_t>(l)];
    roots.resize(level.clusters.size());
    for (std::size_t i = 0; i < roots.size(); ++i)
      roots[i] = l == top ? static_cast<std::uint32_t>(i) : root_of(l, i);
  }
}

// Of a cluster below the top.
std::uint32_t SheetLeaves::root_of(int l, std::size_t cluster) const {
  const std::uint32_t parent = clusters_->level(l).clusters[cluster].parent;
  return parent == no_cluster ? no_cluster
                              : root_clusters_[static_cast<std::size_t>(l) + 1][parent];
}

// The vertex of the cluster above that has taken it in.
std::uint32_t SheetLeaves::inherited(int l, std::size_t cluster) const {
  const std::uint32_t parent = clusters_->level(l).clusters[cluster].parent;
  return parent == no_cluster ? no_cluster : vertices_[static_cast<std::size_t>(l) + 1][parent];
}

// covered: a vertex of a node above lies in this node's cube, or may.
void SheetLeaves::visit(int l, std::size_t node, bool covered) {
  const ClusterLevel& level = clusters_->level(l);
  std::vector<std::uint32_t>& vertices = vertices_[static_cast<std::size_t>(l)];
  const bool shares = covered || (l > 0 && !clusters_->is_one(l, node));
  for (std::uint32_t i = level.first_cluster[node]; i < level.first_cluster[node + 1]; ++i) {
    vertices[i] = inherited(l, i);
    if (vertices[i] != no_cluster || !level.clusters[i].collapses) continue;
    vertices[i] = static_cast<std::uint32_t>(out_->vertices.size());
    if (l == 0) finest_.push_back({static_cast<std::uint32_t>(node), i, vertices[i]});
    add_vertex(l, i, shares);
  }
  if (l == 0) return;
  if (level.kinds[node] == NodeKind::simple) {
    const std::uint32_t vertex = vertices[level.first_cluster[node]];
    if (vertex != no_cluster) return pass_down(l, node, vertex);
  }
  for (std::uint32_t i = level.first_cluster[node]; i < level.first_cluster[node + 1]; ++i)
    covered = covered || level.clusters[i].collapses;
  for (std::uint32_t child = level.first_child[node]; child < level.first_child[node + 1]; ++child)
    visit(l - 1, child, covered);
}

// All sheets below a simple node: its cells have one each, and lie together.
void SheetLeaves::pass_down(int l, std::size_t node, std::uint32_t vertex) {
  std::size_t begin = node, end = node + 1;
  for (int below = l; below > 0; --below) {
    begin = clusters_->level(below).first_child[begin];
    end = clusters_->level(below).first_child[end];
  }
  const std::vector<std::uint32_t>& first = clusters_->level(0).first_cluster;
  std::fill(vertices_[0].begin() + first[begin], vertices_[0].begin() + first[end], vertex);
}

LeafCounts& SheetLeaves::counts_of(std::uint8_t root) {
  return root == no_root ? final_ : record_.clusters[root].leaves;
}

void SheetLeaves::add_vertex(int l, std::size_t number, bool shares) {
  const SheetCluster& cluster = clusters_->level(l).clusters[number];
  const LeafCode leaf = LeafCode::make(cluster.first.code(), l, cluster.first.sheet());
  out_->vertices.push_back({leaf.with(cluster.normals.sense).sharing(shares),
                            cluster.solution.offset, pack_clusters(cluster.normals)});
  const std::size_t top = root_clusters_.size() - 1;
  const std::uint32_t root =
      static_cast<std::size_t>(l) == top ? static_cast<std::uint32_t>(number) : root_of(l, number);
  roots_.push_back(root == no_cluster ? no_root : static_cast<std::uint8_t>(root));
  LeafCounts& counts = counts_of(roots_.back());
  ++counts.leaves[static_cast<std::size_t>(l)];
  if (l > 0)
    counts.worst_residual =
        std::max(counts.worst_residual, static_cast<double>(cluster.solution.residual));
}

void SheetLeaves::solve_finest(const BrickFrame& frame, const ContourParameters& parameters) {
  const ClusterLevel& level = clusters_->level(0);
  NodeSolver solver(parameters);
  for (std::size_t begin = 0; begin < finest_.size(); begin += lanes) {
    const std::size_t count = std::min(lanes, finest_.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      solver.load(i, level.clusters[finest_[begin + i].sheet].qef);
      if (solver.needs_centres())
        solver.set_centre(
            i, node_centre(frame, 0, level.codes[finest_[begin + i].cell], parameters.spacing));
    }
    solver.solve(0, count);
    for (std::size_t i = 0; i < count; ++i) {
      const NodeSolution solution = solver.solution(i);
      out_->vertices[finest_[begin + i].vertex].offset = solution.offset;
      double& worst = counts_of(roots_[finest_[begin + i].vertex]).worst_finest;
      worst = std::max(worst, static_cast<double>(solution.residual));
    }
  }
}

void SheetLeaves::count_blocks(const BrickFrame& frame) {
  taken_.clear();
  for (int l = std::min(block_level, frame.level); l >= 0; --l) {
    std::swap(taken_, taken_above_);
    const ClusterLevel& level = clusters_->level(l);
    taken_.assign(level.clusters.size(), 0);
    for (std::size_t i = 0; i < level.clusters.size(); ++i) {
      const SheetCluster& cluster = level.clusters[i];
      if (l < block_level && cluster.parent != no_cluster && taken_above_[cluster.parent] != 0) {
        taken_[i] = 1;
      } else if (cluster.collapses) {
        taken_[i] = 1;
        ++out_->blocks[cluster.first.code() >> (3 * block_level)].vertices;
      }
    }
  }
}

}  // namespace voxweld
