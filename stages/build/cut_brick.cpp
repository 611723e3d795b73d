#include "stages/build/cut_brick.h"

#include <algorithm>
#include <tuple>

#include "stages/build/brick_polygons.h"
#include "stages/contouring/cell_topology.h"

namespace voxweld {
namespace {

constexpr std::uint32_t none = BrickLevels::none;
constexpr std::uint32_t kept_bit = 0x80000000u;  // in order_: of a kept cluster

// Vertices are in this order: by node from the top down, then by first cell and sheet.
auto order_of(LeafCode leaf) {
  const int l = leaf.level();
  return std::tuple(leaf.code() >> (3 * l) << (3 * l), -l, leaf.code(), leaf.sheet());
}

bool lies_in(LeafCode leaf, LeafCode node) {
  return leaf.level() < node.level() &&
         leaf.code() >> (3 * node.level()) == node.code() >> (3 * node.level());
}

}  // namespace

// Both, each of which may have grown to twice its content, and five numbers a vertex.
std::uint64_t cut_bytes(std::uint64_t brick_bytes) {
  return 5 * brick_bytes;
}

void BrickCutter::cut(const BrickOctree& finer, double tolerance, BrickOctree& out) {
  finer_ = &finer;
  tolerance_ = tolerance;
  out_ = &out;
  out = {};
  out.root = finer.root;
  out.counts.active_cells = finer.counts.active_cells;
  out.counts.crossing_edges = finer.counts.crossing_edges;
  follow_clusters();
  list_vertices();
  set_sharing();
  cut_record();
  cut_polygons();
  cut_blocks();
  cut_ghosts();
}

bool BrickCutter::collapses(std::uint32_t kept) const {
  return static_cast<double>(finer_->levels.clusters[kept].error) <= tolerance_;
}

// Errors rise with the levels: those that collapse lie below those that do not.
void BrickCutter::follow_clusters() {
  const std::vector<KeptCluster>& clusters = finer_->levels.clusters;
  top_.assign(clusters.size(), none);
  left_.assign(clusters.size(), none);
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    const std::uint32_t parent = clusters[i].parent;
    if (collapses(i)) {
      top_[i] = parent != none && collapses(parent) ? top_[parent] : i;
      continue;
    }
    left_[i] = static_cast<std::uint32_t>(out_->levels.clusters.size());
    out_->levels.clusters.push_back(clusters[i]);
    if (parent != none) out_->levels.clusters.back().parent = left_[parent];
  }
}

// The vertices that stay, and the clusters that become some.
void BrickCutter::list_vertices() {
  const BrickLevels& levels = finer_->levels;
  const auto leaf = [&](std::uint32_t from) {
    return (from & kept_bit) != 0 ? levels.clusters[from & ~kept_bit].vertex.leaf
                                  : finer_->vertices[from].leaf;
  };
  order_.clear();
  for (std::uint32_t v = 0; v < finer_->vertices.size(); ++v)
    if (levels.parents[v] == none || !collapses(levels.parents[v])) order_.push_back(v);
  const auto middle = static_cast<std::ptrdiff_t>(order_.size());
  for (std::uint32_t i = 0; i < levels.clusters.size(); ++i)
    if (top_[i] == i) order_.push_back(i | kept_bit);
  std::inplace_merge(
      order_.begin(), order_.begin() + middle, order_.end(),
      [&](std::uint32_t a, std::uint32_t b) { return order_of(leaf(a)) < order_of(leaf(b)); });
  place_.assign(finer_->vertices.size(), none);
  cluster_place_.assign(levels.clusters.size(), none);
  for (const std::uint32_t from : order_) add_vertex(from);
  for (std::uint32_t v = 0; v < place_.size(); ++v) {
    if (place_[v] != none) continue;
    place_[v] = cluster_place_[top_[levels.parents[v]]];
    out_->roots[place_[v]] = finer_->roots[v];
  }
}

// from: as order_ has it.
void BrickCutter::add_vertex(std::uint32_t from) {
  const bool stays = (from & kept_bit) == 0;
  const std::uint32_t i = from & ~kept_bit;
  const BrickLevels& levels = finer_->levels;
  const auto place = static_cast<std::uint32_t>(out_->vertices.size());
  (stays ? place_ : cluster_place_)[i] = place;
  out_->vertices.push_back(stays ? finer_->vertices[i] : levels.clusters[i].vertex);
  // Of a cluster: told by what it takes in.
  out_->roots.push_back(stays ? finer_->roots[i] : BrickOctree::no_root);
  out_->levels.errors.push_back(stays ? levels.errors[i] : levels.clusters[i].error);
  const std::uint32_t parent = stays ? levels.parents[i] : levels.clusters[i].parent;
  out_->levels.parents.push_back(parent == none ? none : left_[parent]);
}

// A vertex shares its node's cube with that of a node above too.
void BrickCutter::set_sharing() {
  std::vector<LeafCode> above;
  for (LeafVertex& vertex : out_->vertices) {
    while (!above.empty() && !lies_in(vertex.leaf, above.back())) above.pop_back();
    if (!above.empty()) vertex.leaf = vertex.leaf.sharing(true);
    above.push_back(vertex.leaf);
  }
}

void BrickCutter::cut_record() {
  NodeRecord& record = out_->record;
  record = finer_->record;
  for (ClusterRecord& cluster : record.clusters) {
    cluster.collapses =
        cluster.may_collapse() && static_cast<double>(cluster.residual) <= tolerance_ ? 1u : 0u;
    cluster.leaves = {};
  }
  LeafCounts final;
  for (std::size_t v = 0; v < out_->vertices.size(); ++v) {
    const std::uint8_t root = out_->roots[v];
    LeafCounts& counts = root == BrickOctree::no_root ? final : record.clusters[root].leaves;
    const int level = out_->vertices[v].leaf.level();
    ++counts.leaves[static_cast<std::size_t>(level)];
    counts.note_error(level, out_->levels.errors[v]);
    if (root == BrickOctree::no_root) ++out_->counts.vertices;
  }
  out_->counts.by_level = final;
}

void BrickCutter::cut_polygons() {
  out_->blocks.assign(finer_->blocks.size(), BlockCount{});
  std::size_t next = 0;
  for (std::size_t b = 0; b < finer_->blocks.size(); ++b) {
    for (; next < finer_->blocks[b].polygon_end; ++next) {
      PolygonRefs refs = finer_->polygons[next];
      for (CornerRef& ref : refs)
        if (!ref.is_foreign()) ref = CornerRef::local(place_[ref.vertex()]);
      if (may_be_polygon(refs)) out_->polygons.push_back(refs);
    }
    out_->blocks[b].polygon_end = static_cast<std::uint32_t>(out_->polygons.size());
  }
}

void BrickCutter::cut_blocks() {
  for (std::size_t b = 0; b < finer_->blocks.size(); ++b)
    out_->blocks[b].vertices = finer_->blocks[b].vertices;
  for (const BlockMerge& merge : finer_->levels.merges) {
    if (static_cast<double>(merge.error) <= tolerance_)
      out_->blocks[merge.block()].vertices -= merge.fewer();
    else
      out_->levels.merges.push_back(merge);
  }
}

void BrickCutter::cut_ghosts() {
  const GhostLayer& finer = finer_->ghost;
  GhostLayer& ghost = out_->ghost;
  const auto vertex = [&](std::uint32_t number) {
    return place_[finer.vertices[number].brick_vertex];
  };
  // Else its vertices are in the list `apart`, at the same place before and after.
  const auto has_one = [](const GhostCell& cell) {
    return cell_sheets(static_cast<CellSigns>(cell.signs()), cell.joined()).sheets == 1;
  };
  marks_.assign(out_->vertices.size(), 0);
  for (const GhostCell& cell : finer.cells)
    if (has_one(cell)) marks_[vertex(cell.first())] = 1;
  for (const std::uint32_t number : finer.apart) marks_[vertex(number)] = 1;
  add_ghost_vertices(marks_, *out_);
  for (const std::uint32_t number : finer.apart) ghost.apart.push_back(marks_[vertex(number)]);
  for (const GhostCell& cell : finer.cells)
    ghost.cells.push_back(has_one(cell) ? cell.with_first(marks_[vertex(cell.first())]) : cell);
}

}  // namespace voxweld
