#include "stages/merge/cluster_reduction.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace voxweld {
namespace {

Vec3 centre_of(CellKey key, Vec3 spacing) {
  Vec3 centre;
  for (int a = 0; a < 3; ++a)
    centre[a] =
        ((static_cast<double>(key.at[a]) + 0.5) * static_cast<double>(key.side()) - 1) * spacing[a];
  return centre;
}

// Keeps the leaves named by `used`, in their order; where each of them is then.
std::vector<std::uint32_t> keep_sorted(std::vector<std::uint32_t> used,
                                       std::vector<ClusterLeaf>& leaves) {
  const auto key = [&](std::uint32_t i) {
    return std::tuple(leaves[i].key().code(), leaves[i].level, leaves[i].first);
  };
  std::sort(used.begin(), used.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> place(leaves.size(), no_cluster);
  std::vector<ClusterLeaf> sorted;
  sorted.reserve(used.size());
  for (const std::uint32_t i : used) {
    place[i] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(leaves[i]);
  }
  leaves = std::move(sorted);
  return place;
}

}  // namespace

ClusterReduction::ClusterReduction(CellKey root, int domain_level,
                                   const ContourParameters& parameters)
    : root_(root),
      domain_level_(domain_level),
      spacing_(parameters.spacing),
      solver_(parameters),
      sum_(parameters),
      sealing_(parameters.simplify.sealing) {}

void ClusterReduction::push(CellKey key, const NodeRecord& record) {
  if (key != root_) {
    while (!open_.empty() && !open_.back().key.cells().contains(key.cells())) close_last();
    open_down_to(key.parent());
  }
  result_.nodes.push_back({key.code(), static_cast<std::uint32_t>(result_.links.size()), 0});
  const auto first = static_cast<std::uint32_t>(tree_.size());
  first_of_node_.push_back(first);
  result_.links.resize(result_.links.size() + record.clusters.size());
  tree_.resize(tree_.size() + record.clusters.size());
  if (key == root_)
    whole_ = {record, first};
  else
    add_child(key, {record, first});
}

void ClusterReduction::open_down_to(CellKey parent) {
  const auto next_node = static_cast<std::uint32_t>(result_.nodes.size()),
             next_leaf = static_cast<std::uint32_t>(result_.leaves.size());
  if (open_.empty()) open_.push_back({root_, next_node, next_leaf, {}});
  while (open_.back().key.level > parent.level) {
    const CellKey key = open_.back().key;
    open_.push_back({key.child(key.octant_of(parent)), next_node, next_leaf, {}});
  }
}

void ClusterReduction::close_last() {
  OpenNode node = std::move(open_.back());
  open_.pop_back();
  Child merged = merge(node);
  if (open_.empty())
    whole_ = std::move(merged);
  else
    add_child(node.key, std::move(merged));
}

void ClusterReduction::add_child(CellKey key, Child child) {
  OpenNode& parent = open_.back();
  parent.children[static_cast<std::size_t>(parent.key.octant_of(key))] = std::move(child);
}

// What can become part of nothing any more.
void ClusterReduction::keep(const Child& child) {
  for (const ClusterRecord& cluster : child.record.clusters) add(result_.counts, cluster.leaves);
}

// Whether all that is below the node may go on collapsing: its shape is the merger's then.
bool ClusterReduction::find_shape(const OpenNode& node) {
  if (node.key.level > domain_level_) return false;
  merger_.begin(node.key);
  for (std::size_t octant = 0; octant < 8; ++octant) {
    if (!node.children[octant]) continue;
    const NodeRecord& child = node.children[octant]->record;
    if (child.blocked) return false;
    if (child.clusters.empty()) continue;
    euler_[octant].clear();
    for (const ClusterRecord& cluster : child.clusters) euler_[octant].push_back(cluster.euler);
    merger_.add(static_cast<int>(octant), {euler_[octant], child.curves, child.pairs});
  }
  merger_.merge();
  return !is_sealed(node.key.level, merger_.shape(), sealing_);
}

ClusterReduction::Child ClusterReduction::merge(const OpenNode& node) {
  Child merged{{}, static_cast<std::uint32_t>(tree_.size())};
  NodeRecord& record = merged.record;
  record.blocked = !find_shape(node);
  if (record.blocked) {
    for (const std::optional<Child>& child : node.children)
      if (child) keep(*child);
    return merged;
  }
  const NodeShape shape = merger_.shape();
  record.closes = merger_.closes();
  record.curves.assign(shape.curves.begin(), shape.curves.end());
  record.pairs.assign(shape.pairs.begin(), shape.pairs.end());
  record.clusters.resize(shape.euler.size());
  tree_.resize(tree_.size() + shape.euler.size());
  for (std::size_t i = 0; i < shape.euler.size(); ++i) record.clusters[i].euler = shape.euler[i];
  std::size_t number = 0;  // of the children's clusters
  for (const std::optional<Child>& child : node.children) {
    if (!child) continue;
    record.closes = record.closes || child->record.closes;
    for (std::uint32_t i = 0; i < child->record.clusters.size(); ++i)
      join(child->record.clusters[i], child->first_cluster + i, merger_.cluster_of()[number++],
           merged);
  }
  const std::size_t first_own = result_.leaves.size();
  for (std::uint32_t i = 0; i < record.clusters.size(); ++i) {
    solve(node, i, record.clusters[i]);
    if (record.clusters[i].collapses != 0)
      add_leaf(node, record, i, tree_[merged.first_cluster + i]);
  }
  if (result_.leaves.size() > first_own) {
    ++collapsed_;
    for (std::size_t i = node.first_leaf; i < first_own; ++i) result_.leaves[i].shares = 1;
    for (std::size_t i = node.first_node; i < result_.nodes.size(); ++i)
      result_.nodes[i].covered = 1;
  }
  return merged;
}

// A child's cluster to the node's.
void ClusterReduction::join(const ClusterRecord& cluster, std::uint32_t place, std::uint32_t into,
                            Child& merged) {
  if (into == no_cluster) return add(result_.counts, cluster.leaves);
  tree_[place].parent = merged.first_cluster + into;
  ClusterRecord& sum = merged.record.clusters[into];
  if (cluster.first < sum.first) sum.first = cluster.first;
  add(sum.leaves, cluster.leaves);
}

// Its QEF and normals from those of the children, and whether it collapses.
void ClusterReduction::solve(const OpenNode& node, std::uint32_t number, ClusterRecord& cluster) {
  solver_.clear_children();
  solver_.set_centre(0, centre_of(node.key, spacing_));
  sum_.begin(solver_, 0);
  std::size_t at = 0;
  for (int octant = 0; octant < 8; ++octant) {
    const std::optional<Child>& child = node.children[static_cast<std::size_t>(octant)];
    if (!child) continue;
    for (const ClusterRecord& part : child->record.clusters)
      if (merger_.cluster_of()[at++] == number)
        sum_.add(octant, part.qef, part.normals, centre_of(node.key.child(octant), spacing_));
  }
  cluster.normals = sum_.finish();
  solver_.merge(node.key.level - 1);
  cluster.qef = solver_.qef(0);
  if (!merger_.may_collapse(number)) return;
  solver_.solve(node.key.level, 1);
  const NodeSolution solution = solver_.solution(0);
  if (!solver_.within_tolerance(solution)) return;
  cluster.collapses = 1;
  cluster.offset = solution.offset;
  cluster.residual = solution.residual;
  cluster.leaves = {};
  cluster.leaves.leaves[static_cast<std::size_t>(node.key.level)] = 1;
  cluster.leaves.note_error(node.key.level, solution.residual);
}

void ClusterReduction::add_leaf(const OpenNode& node, const NodeRecord& record, std::size_t number,
                                Cluster& place) {
  const ClusterRecord& cluster = record.clusters[number];
  place.leaf = static_cast<std::uint32_t>(result_.leaves.size());
  result_.leaves.push_back(
      {cluster.first,
       static_cast<std::uint32_t>(node.key.level),
       record.is_one() ? 0u : 1u,
       {LeafCode{}.with(cluster.normals.sense), cluster.offset, pack_clusters(cluster.normals)},
       cluster.residual});
}

ReducedNode ClusterReduction::finish() {
  while (!open_.empty()) close_last();
  resolve();
  result_.record = std::move(whole_.record);
  return std::move(result_);
}

// Each cluster to the highest leaf above it, and to the root's cluster. Parents come later in the
// tree than what they take in.
void ClusterReduction::resolve() {
  std::vector<std::uint32_t> root(tree_.size(), no_cluster);
  for (std::size_t i = tree_.size(); i-- > 0;) {
    if (i >= whole_.first_cluster && !whole_.record.clusters.empty())
      root[i] = static_cast<std::uint32_t>(i) - whole_.first_cluster;
    if (tree_[i].parent == no_cluster) continue;
    root[i] = root[tree_[i].parent];
    if (tree_[tree_[i].parent].leaf != no_cluster) tree_[i].leaf = tree_[tree_[i].parent].leaf;
  }
  sort_leaves();
  each_link([&](std::uint32_t place, ClusterLink& link) {
    link = {tree_[place].leaf, root[place]};
  });
}

template <class F>
void ClusterReduction::each_link(const F& f) {
  for (std::size_t n = 0; n < result_.nodes.size(); ++n) {
    const std::uint32_t first = result_.nodes[n].first_link;
    for (std::uint32_t i = first; i < result_.end_of_links(n); ++i)
      f(first_of_node_[n] + (i - first), result_.links[i]);
  }
}

// Those that are used, in the order of ReducedNode.
void ClusterReduction::sort_leaves() {
  std::vector<bool> seen(result_.leaves.size());
  std::vector<std::uint32_t> used;
  each_link([&](std::uint32_t at, const ClusterLink&) {
    const std::uint32_t leaf = tree_[at].leaf;
    if (leaf == no_cluster || seen[leaf]) return;
    seen[leaf] = true;
    used.push_back(leaf);
  });
  const std::vector<std::uint32_t> place = keep_sorted(std::move(used), result_.leaves);
  for (Cluster& cluster : tree_)
    if (cluster.leaf != no_cluster) cluster.leaf = place[cluster.leaf];
}

namespace {

// Puts together what lies above some bricks, shard by shard.
class BricksAbove {
 public:
  BricksAbove(const ReducedNode& top, std::span<const std::uint64_t> wanted)
      : top_(top), wanted_(wanted) {}

  void add(const ShardClusters& shard) {
    begin(shard);
    const ReducedNode& node = *shard.node;
    for (std::size_t n = 0; n < node.nodes.size(); ++n) {
      const LinkedNode& brick = node.nodes[n];
      if (!std::ranges::binary_search(wanted_, brick.code)) continue;
      above_.bricks.push_back({brick.code, static_cast<std::uint32_t>(above_.links.size()),
                               brick.covered | (place_ != nullptr ? place_->covered : 0)});
      for (std::size_t i = brick.first_link; i < node.end_of_links(n); ++i)
        above_.links.push_back(leaf_of(node, node.links[i]));
    }
  }

  AboveBricks finish() {
    std::vector<std::uint32_t> all(above_.leaves.size());
    std::iota(all.begin(), all.end(), 0u);
    const std::vector<std::uint32_t> place = keep_sorted(std::move(all), above_.leaves);
    for (std::uint32_t& link : above_.links)
      if (link != no_cluster) link = place[link];
    return std::move(above_);
  }

 private:
  void begin(const ShardClusters& shard) {
    const auto at = std::ranges::lower_bound(top_.nodes, shard.code, {}, &LinkedNode::code);
    place_ = at == top_.nodes.end() || at->code != shard.code ? nullptr : &*at;
    own_place_.assign(shard.node->leaves.size(), no_cluster);
    taken_in_.assign(shard.node->leaves.size(), 0);
    for (const ClusterLink& link : shard.node->links)
      if (link.leaf != no_cluster && leaf_in_top(link) != no_cluster) taken_in_[link.leaf] = 1;
  }

  std::uint32_t leaf_in_top(const ClusterLink& link) const {
    if (place_ == nullptr || link.root == no_cluster) return no_cluster;
    return top_.links[place_->first_link + link.root].leaf;
  }

  std::uint32_t leaf_of(const ReducedNode& shard, const ClusterLink& link) {
    if (const std::uint32_t leaf = leaf_in_top(link); leaf != no_cluster)
      return keep(top_.leaves, leaf, [&](std::uint32_t i) -> std::uint32_t& {
        return top_place_.try_emplace(i, no_cluster).first->second;
      });
    if (link.leaf == no_cluster) return no_cluster;
    return keep(shard.leaves, link.leaf,
                [&](std::uint32_t i) -> std::uint32_t& { return own_place_[i]; });
  }

  // A leaf, and those before it that are of the same node: snapping it needs them. But what a leaf
  // above has taken in is none. Its place in above_.
  template <class PlaceOf>
  std::uint32_t keep(const std::vector<ClusterLeaf>& leaves, std::uint32_t leaf,
                     const PlaceOf& place_of) {
    const bool own = &leaves != &top_.leaves;
    for (std::uint32_t i = leaf;; --i) {
      std::uint32_t& place = place_of(i);
      if (place == no_cluster && !(own && taken_in_[i] != 0)) {
        place = static_cast<std::uint32_t>(above_.leaves.size());
        above_.leaves.push_back(leaves[i]);
        if (own && place_ != nullptr) above_.leaves.back().shares |= place_->covered;
      }
      if (i == 0 || leaves[i - 1].level != leaves[leaf].level ||
          leaves[i - 1].key() != leaves[leaf].key())
        return place_of(leaf);
    }
  }

  const ReducedNode& top_;
  std::span<const std::uint64_t> wanted_;
  AboveBricks above_;
  std::map<std::uint32_t, std::uint32_t> top_place_;  // of those of top_ that are kept
  // Of the shard under way.
  const LinkedNode* place_ = nullptr;     // in top_, if anything is above
  std::vector<std::uint32_t> own_place_;  // of its leaves
  std::vector<std::uint8_t> taken_in_;    // 1: a leaf of top_ has taken it in
};

}  // namespace

AboveBricks bricks_above(std::span<const ShardClusters> shards, const ReducedNode& top,
                         std::span<const std::uint64_t> bricks) {
  BricksAbove above(top, bricks);
  for (const ShardClusters& shard : shards) above.add(shard);
  return above.finish();
}

}  // namespace voxweld
