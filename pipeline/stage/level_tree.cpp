#include "pipeline/stage/level_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

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

// Of vertices in a node, where the tolerance is four times that of its children; half of them with eight times.
constexpr double part_left = 0.25;
constexpr int level_doublings = 2;

// Makes nodes from the leaves up; their numbers are put in order afterwards.
class TreeBuilder {
 public:
  TreeBuilder(const std::vector<LevelLeaf>& leaves, const LevelTreeRules& rules)
      : leaves_(leaves), rules_(rules), order_(leaves.size()) {
    std::iota(order_.begin(), order_.end(), std::uint64_t{0});
    // A cube before those that it holds.
    std::ranges::sort(order_, {}, [&](std::uint64_t leaf) {
      return std::tuple(place(leaf).code(), -place(leaf).level, leaf);
    });
  }

  std::vector<LevelNode> build() {
    if (leaves_.empty()) return {};
    const Parts all = parts_of(order_);
    if (!all.nodes.empty() && all.nodes.size() + all.leaves.size() > 1) add_node(all);
    const auto high = [&] { return nodes_.empty() ? 0 : nodes_.back().height; };
    while (rules_.levels > 0 && high() < rules_.levels - 1) add_above();
    return std::move(nodes_);
  }

 private:
  using Leaves = std::span<const std::uint64_t>;
  // What stands for some leaves.
  struct Parts {
    std::vector<std::uint64_t> nodes, leaves;
    CellKey cell;         // around all that they stand for
    double vertices = 0;  // about
  };

  CellKey place(std::uint64_t leaf) const { return leaves_[leaf].place; }

  Parts parts_of(Leaves leaves) {
    Parts parts;
    parts.cell = place(leaves.front());
    if (leaves.size() == 1) {
      parts.leaves.push_back(leaves.front());
      parts.vertices = static_cast<double>(leaves_[leaves.front()].vertices);
      return parts;
    }
    for (const std::uint64_t leaf : leaves) parts.cell = common_cell(parts.cell, place(leaf));
    parts.cell = raised(parts.cell, rules_.least);
    while (!leaves.empty()) {
      const Leaves some = leaves.first(those_together(parts.cell, leaves));
      const Parts inner = parts_of(some);
      parts.nodes.insert(parts.nodes.end(), inner.nodes.begin(), inner.nodes.end());
      parts.leaves.insert(parts.leaves.end(), inner.leaves.begin(), inner.leaves.end());
      parts.vertices += inner.vertices;
      leaves = leaves.subspan(some.size());
    }
    const bool few = parts.vertices <= static_cast<double>(rules_.few_vertices);
    return few && rules_.few_vertices > 0 ? parts : add_node(parts);
  }
  Parts add_node(const Parts& parts) {
    LevelNode node{parts.cell, 1, level_doublings, false, parts.nodes, parts.leaves};
    for (const std::uint64_t child : node.nodes) {
      node.height = std::max(node.height, nodes_[child].height + 1);
      node.doublings = std::max(node.doublings, nodes_[child].doublings + level_doublings);
    }
    double left = parts.vertices * part_left;
    const bool many = rules_.most_vertices > 0 && left > static_cast<double>(rules_.most_vertices);
    if (many &&
        std::ldexp(rules_.tolerance, node.doublings + 1) <= std::ldexp(1.0, node.cell.level - 6)) {
      ++node.doublings;
      left /= 2;
    }
    nodes_.push_back(std::move(node));
    return {{nodes_.size() - 1}, {}, parts.cell, left};
  }
  // How many of the first ones lie in one octant of the cell; 1 where the first fills the cell.
  std::size_t those_together(CellKey cell, Leaves leaves) const {
    const CellKey first = place(leaves.front());
    if (cell.level <= rules_.least || first.level >= cell.level) return 1;
    const auto end = std::ranges::find_if(leaves, [&](std::uint64_t leaf) {
      return cell.octant_of(place(leaf)) != cell.octant_of(first);
    });
    return static_cast<std::size_t>(end - leaves.begin());
  }
  // One node above another, or above leaves that need none.
  void add_above() {
    LevelNode node;
    if (nodes_.empty()) {
      node.cell = raised(parts_of(order_).cell, rules_.least);
      node.leaves = order_;
    } else {
      node.cell = nodes_.back().cell;  // the root was built last
      node.height = nodes_.back().height + 1;
      node.doublings = nodes_.back().doublings + level_doublings;
      node.nodes = {nodes_.size() - 1};
    }
    nodes_.push_back(std::move(node));
  }

  const std::vector<LevelLeaf>& leaves_;
  const LevelTreeRules rules_;
  std::vector<std::uint64_t> order_;  // by place
  std::vector<LevelNode> nodes_;
};

}  // namespace

std::string LevelNode::name() const {
  return std::to_string(height) + "/" + cube_name(cell);
}

LevelTree::LevelTree(std::vector<LevelLeaf> leaves, const LevelTreeRules& rules)
    : leaves_(std::move(leaves)), of_labels_(rules.of_labels), leaf_parents_(leaves_.size(), none) {
  take(TreeBuilder(leaves_, rules).build(), rules.levels);
  mark_whole();
}

// Those of no more height than there are levels, children before their parents.
void LevelTree::take(std::vector<LevelNode> built, std::int64_t levels) {
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
    for (const std::uint64_t leaf : node.leaves) leaf_parents_[leaf] = nodes_.size() - 1;
    if (ends_.size() < static_cast<std::size_t>(node.height)) ends_.push_back(0);
    ends_.back() = nodes_.size();
  }
}

void LevelTree::mark_whole() {
  if (!root_leaves().empty() || root_nodes().size() != 1) return;
  for (LevelNode* node = &nodes_.back(); node != nullptr;
       node = node->leaves.empty() && node->nodes.size() == 1 ? &nodes_[node->nodes[0]] : nullptr)
    node->all = true;
}

std::vector<std::uint64_t> LevelTree::root_nodes() const {
  std::vector<std::uint64_t> roots;
  for (std::uint64_t n = 0; n < nodes_.size(); ++n)
    if (parents_[n] == none) roots.push_back(n);
  return roots;
}

std::vector<std::uint64_t> LevelTree::root_leaves() const {
  std::vector<std::uint64_t> roots;
  for (std::uint64_t t = 0; t < leaves_.size(); ++t)
    if (leaf_parents_[t] == none) roots.push_back(t);
  return roots;
}

std::vector<std::uint64_t> LevelTree::all_leaves(std::uint64_t node) const {
  std::vector<std::uint64_t> found, open = {node};
  while (!open.empty()) {
    const LevelNode& at = nodes_[open.back()];
    open.pop_back();
    found.insert(found.end(), at.leaves.begin(), at.leaves.end());
    open.insert(open.end(), at.nodes.begin(), at.nodes.end());
  }
  std::ranges::sort(found);
  return found;
}

std::vector<LevelSurface> LevelTree::surfaces(std::uint64_t number) const {
  const auto label = [&](std::uint64_t leaf) { return leaves_[leaf].label; };
  const std::vector<std::uint64_t> leaves = all_leaves(number);
  std::vector<std::uint64_t> own = nodes_[number].leaves;
  std::ranges::sort(own);
  std::vector<LevelSurface> surfaces;
  auto next = own.begin();
  for (auto begin = leaves.begin(); begin != leaves.end();) {
    LevelSurface& surface = surfaces.emplace_back();
    surface.label = label(*begin);
    const auto end = std::find_if(begin, leaves.end(),
                                  [&](std::uint64_t leaf) { return label(leaf) != surface.label; });
    // Numbers of a label's leaves follow each other.
    const std::uint64_t first = *begin, last = *(end - 1);
    surface.all = last - first + 1 == static_cast<std::uint64_t>(end - begin) &&
                  (first == 0 || label(first - 1) != surface.label) &&
                  (last + 1 == leaves_.size() || label(last + 1) != surface.label);
    for (; next != own.end() && *next <= last; ++next) surface.leaves.push_back(*next);
    begin = end;
  }
  return surfaces;
}

void LevelTree::add_shape(KeyHasher& key, std::uint64_t number) const {
  const auto add_cell = [&](const CellKey& cell) {
    key.integer(cell.level).integer(static_cast<std::int64_t>(cell.code()));
  };
  const LevelNode& node = nodes_[number];
  add_cell(node.cell);
  key.integer(node.height).integer(node.doublings).integer(node.all ? 1 : 0);
  key.integer(static_cast<std::int64_t>(node.nodes.size()));
  for (const std::uint64_t child : node.nodes) add_shape(key, child);
  key.integer(static_cast<std::int64_t>(node.leaves.size()));
  for (const std::uint64_t leaf : node.leaves) {
    add_cell(leaves_[leaf].place);
    if (of_labels_) key.integer(static_cast<std::int64_t>(leaves_[leaf].label));
  }
}

std::uint64_t LevelTree::bytes() const {
  return leaves_.size() * (sizeof(LevelLeaf) + 3 * sizeof(std::uint64_t)) +
         nodes_.size() * (sizeof(LevelNode) + 16 * sizeof(std::uint64_t));
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
