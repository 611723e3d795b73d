#include "pipeline/output/seam_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <tuple>

namespace voxweld {

std::string tile_name(const CellKey& tile) {
  if (tile == whole_mesh) return "the mesh";
  return fmt::format("tile {}/{},{},{}", tile.level, tile.at.x, tile.at.y, tile.at.z);
}

std::string SeamCheck::place(std::uint32_t tile, std::uint32_t point) const {
  const Vec3 p = frame_.position(index_.points()[point]);
  const std::string label = rules_.label ? fmt::format("label {} ", *rules_.label) : "";
  return fmt::format("{}{} at ({}, {}, {})", label, tile_name(tiles_[tile]), p.x, p.y, p.z);
}

void SeamCheck::add_points(std::uint32_t tile, const TileSeams& seams,
                           std::vector<std::uint32_t>& number) {
  number.resize(seams.points.size());
  for (std::size_t i = 0; i < seams.points.size(); ++i) {
    number[i] = index_.add(seams.points[i]);
    if (number[i] == kept_.size())
      kept_.push_back({.first_tile = tile});
    else
      kept_[number[i]].shared = true;
    if (seams.home[i]) kept_[number[i]].at_home = true;
  }
}

void SeamCheck::add(const CellKey& tile, const TileSeams& seams) {
  const auto at = static_cast<std::uint32_t>(tiles_.size());
  tiles_.push_back(tile);
  std::vector<std::uint32_t> number;
  add_points(at, seams, number);
  for (const auto& [from, to] : seams.half_edges) {
    const std::uint32_t a = number[from], b = number[to];
    half_edges_.push_back({std::min(a, b), std::max(a, b), at & 0x7fffffff, a > b});
  }
  for (const SeamFan& fan : seams.fans) {
    const bool closed = fan.closed;
    fans_.push_back(
        {number[fan.vertex], closed ? 0 : number[fan.from], closed ? 0 : number[fan.to], closed});
  }
  add_label_edges(at, seams, number);
  inner_vertices_ += seams.inner_vertices;
}

void SeamCheck::add_label_edges(std::uint32_t tile, const TileSeams& seams,
                                const std::vector<std::uint32_t>& number) {
  for (const LabelEdge& edge : seams.label_edges) {
    const std::uint32_t a = number[edge.from], b = number[edge.to];
    label_edges_.push_back(
        {std::min(a, b), std::max(a, b), edge.label, tile, a < b ? edge.balance : -edge.balance});
  }
}

std::uint64_t SeamCheck::seam_vertices() const {
  return static_cast<std::uint64_t>(
      std::count_if(kept_.begin(), kept_.end(), [](const KeptPoint& p) { return p.shared; }));
}

std::unordered_map<std::string, std::vector<LatticePoint>> SeamCheck::doubtful() const {
  std::unordered_map<std::string, std::vector<LatticePoint>> out;
  std::unordered_map<std::string, bool> known;
  for (const CellKey& tile : tiles_) known.emplace(tile_name(tile), true);
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i].at_home) continue;
    const Index3 cell = frame_.cell(index_.points()[i]);
    for (int level = 0; level <= max_levels; ++level) {
      const std::string name =
          tile_name({level, {cell.x >> level, cell.y >> level, cell.z >> level}});
      if (known.contains(name)) out[name].push_back(index_.points()[i]);
    }
  }
  return out;
}

void SeamCheck::finish(const Report& report) {
  if (rules_.labels) return check_label_edges(report);
  check_edges(report);
  if (!rules_.free_topology) check_vertices(report);
}

void SeamCheck::check_label_edges(const Report& report) {
  std::sort(
      label_edges_.begin(), label_edges_.end(), [](const SeamLabelEdge& a, const SeamLabelEdge& b) {
        return std::tuple(a.lo, a.hi, a.label, a.tile) < std::tuple(b.lo, b.hi, b.label, b.tile);
      });
  const std::vector<LatticePoint>& points = index_.points();
  for (std::size_t i = 0; i < label_edges_.size();) {
    const SeamLabelEdge& edge = label_edges_[i];
    int balance = 0;
    for (; i < label_edges_.size() && label_edges_[i].lo == edge.lo &&
           label_edges_[i].hi == edge.hi && label_edges_[i].label == edge.label;
         ++i)
      balance += label_edges_[i].balance;
    if (balance == 0) continue;
    ++boundary_edges_;
    if (rules_.open_border && frame_.on_border(points[edge.lo]) &&
        frame_.on_border(points[edge.hi]))
      continue;
    const Vec3 to = frame_.position(points[edge.hi]);
    report(
        {place(edge.tile, edge.lo),
         fmt::format("a crack: the boundary of {} runs {} times more one way than the other "
                     "along the edge to ({}, {}, {})",
                     edge.label == exterior ? "the outside" : fmt::format("label {}", edge.label),
                     std::abs(balance), to.x, to.y, to.z)});
  }
}

void SeamCheck::check_edges(const Report& report) {
  std::sort(half_edges_.begin(), half_edges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tuple(a.lo, a.hi, std::uint32_t{a.tile}) <
           std::tuple(b.lo, b.hi, std::uint32_t{b.tile});
  });
  const HalfEdge* const end = half_edges_.data() + half_edges_.size();
  for (const HalfEdge* first = half_edges_.data(); first != end;) {
    const HalfEdge* last = first;
    while (last != end && last->lo == first->lo && last->hi == first->hi) ++last;
    check_edge(first, last, report);
    first = last;
  }
}

void SeamCheck::check_edge(const HalfEdge* first, const HalfEdge* last, const Report& report) {
  const std::uint64_t total = static_cast<std::uint64_t>(last - first);
  std::uint64_t reversed = 0;
  for (const HalfEdge* h = first; h != last; ++h) reversed += h->reversed;
  const std::uint64_t forward = total - reversed;
  const bool balanced = forward == reversed;
  if (balanced && (rules_.free_topology || forward == 1)) return;
  const bool boundary = rules_.free_topology ? !balanced : total == 1;
  if (boundary) ++boundary_edges_;
  const std::vector<LatticePoint>& points = index_.points();
  if (boundary && rules_.open_border && frame_.on_border(points[first->lo]) &&
      frame_.on_border(points[first->hi]))
    return;
  const Vec3 to = frame_.position(points[first->hi]);
  report({place(first->tile, first->lo),
          boundary && total == 1
              ? fmt::format("a crack: the edge to ({}, {}, {}) has a triangle on one side only",
                            to.x, to.y, to.z)
              : fmt::format("the edge to ({}, {}, {}) is used {} times one way and {} times the "
                            "other, expected once each",
                            to.x, to.y, to.z, forward, reversed)});
}

// Whether the fans of one vertex make one closed disk: one closed fan, or open fans each of which
// begins where another ends, all in one cycle. On an open border: one or more open ones.
bool SeamCheck::is_manifold(const SeamFan* first, const SeamFan* last) const {
  const auto count = static_cast<std::size_t>(last - first);
  std::size_t closed = 0;
  for (const SeamFan* f = first; f != last; ++f) closed += f->closed;
  if (closed > 0) return count == 1;
  // The fan that begins at `from`, when it is the only one.
  const auto following = [&](std::uint32_t from) -> const SeamFan* {
    const SeamFan* found = nullptr;
    for (const SeamFan* f = first; f != last; ++f) {
      if (f->from != from) continue;
      if (found != nullptr) return nullptr;
      found = f;
    }
    return found;
  };
  std::size_t cycle = 1;
  const SeamFan* at = following(first->to);
  for (; at != nullptr && at != first && cycle <= count; ++cycle) at = following(at->to);
  if (at == first) return cycle == count;
  // Some chain has an end: only a boundary, checked as an edge, can be there.
  return rules_.open_border && at == nullptr && frame_.on_border(index_.points()[first->vertex]);
}

void SeamCheck::check_vertices(const Report& report) {
  std::stable_sort(fans_.begin(), fans_.end(),
                   [](const SeamFan& a, const SeamFan& b) { return a.vertex < b.vertex; });
  const SeamFan* const end = fans_.data() + fans_.size();
  for (const SeamFan* first = fans_.data(); first != end;) {
    const SeamFan* last = first;
    while (last != end && last->vertex == first->vertex) ++last;
    if (!is_manifold(first, last))
      report({place(kept_[first->vertex].first_tile, first->vertex),
              fmt::format("not 2-manifold: the triangles around this vertex make no single closed "
                          "fan ({} pieces)",
                          last - first)});
    first = last;
  }
}

}  // namespace voxweld
