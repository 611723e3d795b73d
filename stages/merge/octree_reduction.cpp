#include "stages/merge/octree_reduction.h"

#include <algorithm>

#include "stages/contouring/cell_topology.h"
#include "stages/contouring/label_topology.h"
#include "stages/contouring/normal_clusters.h"

namespace voxweld {
namespace {

bool holds(CellKey node, CellKey key) {
  return node.cells().contains(key.cells());
}

bool homogeneous(const NodeSummary& node) {
  return node.record.state == NodeState::inside || node.record.state == NodeState::outside;
}

CellSigns corner_signs(const NodeSummary& node) {
  if (node.record.state == NodeState::inside) return 255;
  if (node.record.state == NodeState::outside) return 0;
  return static_cast<CellSigns>(node.record.corner_signs);
}

// The 27 labels at half the node's side, as numbers in the order of the materials.
struct NodeMaterials {
  NodeLabels labels{};
  std::array<Material, 8> corners{};
};
NodeMaterials gather_materials(const std::array<NodeSummary, 8>& children) {
  std::array<Material, 27> at{};
  for (std::size_t child = 0; child < 8; ++child) {
    const RootRecord& record = children[child].record;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t x = (child & 1) + (corner & 1), y = (child >> 1 & 1) + (corner >> 1 & 1),
                        z = (child >> 2) + (corner >> 2);
      at[x + 3 * y + 9 * z] =
          record.state == NodeState::outside ? exterior : record.corners[corner];
    }
  }
  std::array<Material, 27> sorted = at;
  std::sort(sorted.begin(), sorted.end());
  NodeMaterials node;
  for (std::size_t i = 0; i < 27; ++i)
    node.labels[i] = static_cast<std::uint32_t>(
        std::lower_bound(sorted.begin(), sorted.end(), at[i]) - sorted.begin());
  for (std::size_t i = 0; i < 8; ++i)
    node.corners[i] = at[2 * (i & 1) + 6 * (i >> 1 & 1) + 18 * (i >> 2)];
  return node;
}

}  // namespace

OctreeReduction::OctreeReduction(CellKey root, int domain_level,
                                 const ContourParameters& parameters, ReductionSink& sink)
    : root_(root),
      domain_level_(domain_level),
      solver_(parameters),
      spacing_(parameters.spacing),
      labels_(parameters.labels.mode == LabelMode::shared),
      sink_(sink) {
  result_.key = root;
}

void OctreeReduction::push(const NodeSummary& node) {
  if (node.key == root_) {
    result_ = node;
    return;
  }
  close_until_holding(node.key);
  open_down_to(node.key.parent());
  add_child(node);
}

void OctreeReduction::open_down_to(CellKey parent) {
  if (open_.empty()) open_.push_back({root_, false, {}});
  while (open_.back().key.level > parent.level) {
    const CellKey key = open_.back().key;
    const CellKey child = key.child(key.octant_of(parent));
    open_.push_back({child, false, {}});
  }
}

void OctreeReduction::close_until_holding(CellKey key) {
  while (!open_.empty() && !holds(open_.back().key, key)) {
    OpenNode node = open_.back();
    open_.pop_back();
    add_child(close(node));
  }
}

void OctreeReduction::add_child(const NodeSummary& node) {
  OpenNode& parent = open_.back();
  if (node.record.state == NodeState::split) {
    mark_split();
    return;  // its leaves and cubes are passed on by whoever pushed or closed it
  }
  if (parent.split) {
    settle(node, sink_);
    return;
  }
  parent.children[static_cast<std::size_t>(parent.key.octant_of(node.key))] = node;
}

// A split node splits all its ancestors: what they kept back is final, the oldest first.
void OctreeReduction::mark_split() {
  for (OpenNode& node : open_) {
    if (node.split) continue;
    node.split = true;
    for (const NodeSummary& child : node.children) settle(child, sink_);
  }
}

void OctreeReduction::settle(const NodeSummary& node, ReductionSink& sink) {
  if (node.record.state != NodeState::leaf) return;
  sink.leaf(node.key, node.record);
  sink.cube({node.key.code(), static_cast<std::uint32_t>(node.key.level), 1, node.polygons});
}

NodeSummary OctreeReduction::close(OpenNode& node) {
  NodeSummary result;
  result.key = node.key;
  if (node.split) {
    result.record.state = NodeState::split;
    return result;
  }
  if (std::all_of(node.children.begin(), node.children.end(), homogeneous)) {
    result.record = node.children[0].record;
    return result;
  }
  if (collapse(node, result)) return result;
  open_.push_back(node);  // it is split: so are those above, whose leaves come first
  mark_split();
  open_.pop_back();
  result.record.state = NodeState::split;
  return result;
}

bool OctreeReduction::corners_allow(const OpenNode& node, RootRecord& result) const {
  if (labels_) {
    const NodeMaterials materials = gather_materials(node.children);
    result.corners = materials.corners;
    return labels_allow_collapse(materials.labels);
  }
  std::array<CellSigns, 8> signs;
  for (std::size_t i = 0; i < 8; ++i) signs[i] = corner_signs(node.children[i]);
  const std::uint32_t signs27 = gather_signs27(signs);
  result.corner_signs = corners_of_signs27(signs27);
  return signs_allow_collapse(signs27);
}

bool OctreeReduction::collapse(const OpenNode& node, NodeSummary& result) {
  if (node.key.level > domain_level_) return false;
  RootRecord corners;
  if (!corners_allow(node, corners)) return false;

  solver_.clear_children();
  ClusterMerge clusters;
  for (std::size_t i = 0; i < 8; ++i) {
    const NodeSummary& child = node.children[i];
    if (child.record.state != NodeState::leaf) continue;
    solver_.set_child(0, static_cast<int>(i), child.record.qef);
    clusters.add(child.record.clusters);
    result.polygons += child.polygons;
  }
  Vec3 centre;
  for (int a = 0; a < 3; ++a) {
    const double side = static_cast<double>(node.key.side());
    centre[a] = ((static_cast<double>(node.key.at[a]) + 0.5) * side - 1) * spacing_[a];
  }
  solver_.set_centre(0, centre);
  solver_.merge(node.key.level - 1);
  solver_.solve(node.key.level, 1);
  const NodeSolution solution = solver_.solution(0);
  if (!solver_.within_tolerance(solution)) {
    result.polygons = 0;
    return false;
  }
  RootRecord& record = result.record;
  record.state = NodeState::leaf;
  record.corner_signs = corners.corner_signs;
  record.corners = corners.corners;
  record.qef = solver_.qef(0);
  record.clusters = clusters.merged();
  record.vertex = {LeafCode{}.with(record.clusters.sense), solution.offset,
                   pack_clusters(record.clusters)};
  record.residual = solution.residual;
  ++collapsed_;
  return true;
}

NodeSummary OctreeReduction::finish() {
  while (!open_.empty()) {
    OpenNode node = open_.back();
    open_.pop_back();
    const NodeSummary closed = close(node);
    if (open_.empty())
      result_ = closed;
    else
      add_child(closed);
  }
  return result_;
}

}  // namespace voxweld
