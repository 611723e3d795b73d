#include "pipeline/stage/level_tree.h"

#include <algorithm>
#include <numeric>

#include "pipeline/stage/file_layout.h"
#include "pipeline/stage/unit_plan.h"

namespace voxweld {
namespace {

// The smallest cube that holds both.
CellKey common_cell(CellKey a, CellKey b) {
  const int level = std::max(a.level, b.level);
  const auto at = [](const CellKey& cell, int up) {
    return Index3{cell.at.x >> up, cell.at.y >> up, cell.at.z >> up};
  };
  CellKey p{level, at(a, level - a.level)}, q{level, at(b, level - b.level)};
  while (p.at != q.at) {
    p = p.parent();
    q = q.parent();
  }
  return p;
}

CellKey raised(CellKey cell, int least) {
  while (cell.level < least) cell = cell.parent();
  return cell;
}

// Makes nodes from the leaves up; their numbers are put in order afterwards.
class TreeBuilder {
 public:
  TreeBuilder(std::span<const CellKey> tiles, int least) : tiles_(tiles), least_(least) {}

  std::vector<LevelNode> build() {
    if (!tiles_.empty()) add(0, tiles_.size(), nullptr);
    return std::move(nodes_);
  }

 private:
  // Of the tiles from `begin` on and before `end`. Returns its height.
  int add(std::size_t begin, std::size_t end, LevelNode* parent) {
    if (end - begin == 1) {
      if (parent != nullptr) parent->tiles.push_back(begin);
      return 0;
    }
    LevelNode node;
    node.cell = raised(common_cell(tiles_[begin], tiles_[end - 1]), least_);
    int height = 0;
    for (std::size_t at = begin; at < end;) {
      std::size_t next = at + 1;
      while (node.cell.level > least_ && next < end && octant(node, next) == octant(node, at))
        ++next;
      height = std::max(height, add(at, next, &node));
      at = next;
    }
    node.height = height + 1;
    nodes_.push_back(std::move(node));
    if (parent != nullptr) parent->nodes.push_back(nodes_.size() - 1);
    return height + 1;
  }
  int octant(const LevelNode& node, std::size_t tile) const {
    return node.cell.octant_of(tiles_[tile]);
  }

  std::span<const CellKey> tiles_;
  const int least_;
  std::vector<LevelNode> nodes_;
};

// One node above another, or above the only tile.
void add_above(std::vector<LevelNode>& nodes, CellKey tile, int least) {
  LevelNode node;
  if (nodes.empty()) {
    node.cell = raised(tile, least);
    node.tiles = {0};
  } else {
    node.cell = nodes.back().cell;
    node.height = nodes.back().height + 1;
    node.nodes = {nodes.size() - 1};
  }
  nodes.push_back(std::move(node));
}

}  // namespace

std::string LevelNode::name() const {
  return std::to_string(height) + "/" + cube_name(cell);
}

LevelTree::LevelTree(std::span<const CellKey> tiles, std::int64_t levels, int least)
    : tiles_(tiles.begin(), tiles.end()), tile_parents_(tiles.size(), none) {
  std::vector<LevelNode> built = TreeBuilder(tiles, least).build();
  // The root was built last.
  while (!tiles.empty() && levels > 0 && (built.empty() ? 0 : built.back().height) < levels - 1)
    add_above(built, tiles.front(), least);
  std::vector<std::uint64_t> order(built.size());
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  std::erase_if(order, [&](std::uint64_t n) { return levels > 0 && built[n].height >= levels; });
  std::ranges::sort(
      order, {}, [&](std::uint64_t n) { return std::pair(built[n].height, built[n].cell.code()); });
  std::vector<std::uint64_t> number(built.size(), none);
  for (std::uint64_t n = 0; n < order.size(); ++n) number[order[n]] = n;
  parents_.assign(order.size(), none);
  for (const std::uint64_t n : order) {
    LevelNode& node = nodes_.emplace_back(std::move(built[n]));
    for (std::uint64_t& child : node.nodes) {
      child = number[child];
      parents_[child] = nodes_.size() - 1;
    }
    for (const std::uint64_t tile : node.tiles) tile_parents_[tile] = nodes_.size() - 1;
    if (ends_.size() < static_cast<std::size_t>(node.height)) ends_.push_back(0);
    ends_.back() = nodes_.size();
  }
  if (root_tiles().empty() && root_nodes().size() == 1)
    for (LevelNode* node = &nodes_.back(); node != nullptr;
         node = node->tiles.empty() && node->nodes.size() == 1 ? &nodes_[node->nodes[0]] : nullptr)
      node->all = true;
}

std::vector<std::uint64_t> LevelTree::root_nodes() const {
  std::vector<std::uint64_t> roots;
  for (std::uint64_t n = 0; n < nodes_.size(); ++n)
    if (parents_[n] == none) roots.push_back(n);
  return roots;
}

std::vector<std::uint64_t> LevelTree::root_tiles() const {
  std::vector<std::uint64_t> roots;
  for (std::uint64_t t = 0; t < tile_parents_.size(); ++t)
    if (tile_parents_[t] == none) roots.push_back(t);
  return roots;
}

void LevelTree::add_shape(KeyHasher& key, std::uint64_t number) const {
  const auto add_cell = [&](const CellKey& cell) {
    key.integer(cell.level).integer(static_cast<std::int64_t>(cell.code()));
  };
  const LevelNode& node = nodes_[number];
  add_cell(node.cell);
  key.integer(node.height).integer(node.all ? 1 : 0);
  key.integer(static_cast<std::int64_t>(node.nodes.size()));
  for (const std::uint64_t child : node.nodes) add_shape(key, child);
  key.integer(static_cast<std::int64_t>(node.tiles.size()));
  for (const std::uint64_t tile : node.tiles) add_cell(tiles_[tile]);
}

std::filesystem::path level_artifact_path(const std::filesystem::path& folder,
                                          const LevelNode& node) {
  return fanned_out(folder / std::to_string(node.height), node.cell.at,
                    cube_name(node.cell) + ".cubes");
}

std::filesystem::path level_record_path(const std::filesystem::path& folder,
                                        const LevelNode& node) {
  return fanned_out(folder / levels_folder / std::to_string(node.height), node.cell.at,
                    cube_name(node.cell) + ".record");
}

std::string level_stem(const LevelNode& node) {
  return std::string(levels_folder) + "/" + node.name();
}

}  // namespace voxweld
