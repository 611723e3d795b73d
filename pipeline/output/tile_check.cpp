#include "pipeline/output/tile_check.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "stages/encode/adjacency.h"

namespace voxweld {

PointFrame::PointFrame(const Manifest& manifest)
    : lattice_(manifest.lattice), geometry_(manifest.frame), slack_(manifest.border_slack) {}

Vec3 PointFrame::position(const LatticePoint& q) const {
  return {lattice_.coordinate(0, q[0]), lattice_.coordinate(1, q[1]), lattice_.coordinate(2, q[2])};
}

Index3 PointFrame::cell(const LatticePoint& q) const {
  const Vec3 p = position(q) - geometry_.first;
  Index3 cell;
  // Samples lie at spacing * index; lattice coordinates are one more (DESIGN: lattice).
  for (int axis = 0; axis < 3; ++axis)
    cell[axis] = static_cast<std::int64_t>(std::floor(p[axis] / geometry_.spacing[axis])) + 1;
  return cell;
}

bool PointFrame::on_border(const LatticePoint& q) const {
  const Vec3 p = position(q) - geometry_.first;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(geometry_.size[axis] - 1) * geometry_.spacing[axis];
    if (p[axis] <= slack_ || p[axis] >= last - slack_) return true;
  }
  return false;
}

namespace {

class SeamFinder {
 public:
  SeamFinder(const LatticeMesh& mesh, const CellKey& tile, const PointFrame& frame)
      : mesh_(mesh),
        tile_(tile),
        frame_(frame),
        adjacency_(std::span<const Triangle>(mesh.triangles), mesh.positions.size()),
        kept_(mesh.positions.size(), PointIndex::none) {}

  TileSeams find() {
    std::vector<Fan> fans;
    const auto count = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::uint32_t v = 0; v < count; ++v) {
      adjacency_.fans(v, fans);
      if (fans.empty()) continue;  // only degenerate triangles used it
      const bool home = tile_.cells().contains(frame_.cell(mesh_.positions[v]));
      if (!home || fans.size() != 1 || !fans[0].closed)
        keep(v, home);
      else
        ++out_.inner_vertices;
    }
    collect_fans();
    collect_half_edges();
    return std::move(out_);
  }

 private:
  void keep(std::uint32_t v, bool home) {
    kept_[v] = static_cast<std::uint32_t>(out_.points.size());
    kept_vertices_.push_back(v);
    out_.points.push_back(mesh_.positions[v]);
    out_.home.push_back(home);
  }

  void collect_fans() {
    std::vector<Fan> fans;
    for (const std::uint32_t v : kept_vertices_) {
      adjacency_.fans(v, fans);
      for (const Fan& fan : fans) {
        // The ends of an open fan are ends of an edge without a reverse, so kept themselves.
        if (fan.closed)
          out_.fans.push_back({kept_[v], 0, 0, true});
        else
          out_.fans.push_back({kept_[v], kept_[fan.from], kept_[fan.to], false});
      }
    }
  }

  void collect_half_edges() {
    for (std::uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
      const std::uint32_t a = kept_[adjacency_.from(h)], b = kept_[adjacency_.to(h)];
      if (a != PointIndex::none && b != PointIndex::none) out_.half_edges.push_back({a, b});
    }
  }

  const LatticeMesh& mesh_;
  const CellKey& tile_;
  const PointFrame& frame_;
  const Adjacency adjacency_;
  std::vector<std::uint32_t> kept_, kept_vertices_;
  TileSeams out_;
};

}  // namespace

TileSeams find_seams(const LatticeMesh& mesh, const CellKey& tile, const PointFrame& frame) {
  return SeamFinder(mesh, tile, frame).find();
}

namespace {

bool is_degenerate(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// One of a triangle's edges for one of its labels: from the lower to the higher vertex.
struct LabelledEdge {
  std::uint32_t lo, hi;
  Material label;
  int way;
  friend bool operator<(const LabelledEdge& a, const LabelledEdge& b) {
    return std::tuple(a.lo, a.hi, a.label) < std::tuple(b.lo, b.hi, b.label);
  }
};

std::vector<LabelledEdge> labelled_edges(const LatticeMesh& mesh) {
  std::vector<LabelledEdge> edges;
  edges.reserve(6 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
      const int way = a < b ? 1 : -1;
      edges.push_back({std::min(a, b), std::max(a, b), mesh.pairs[i].inside, way});
      edges.push_back({std::min(a, b), std::max(a, b), mesh.pairs[i].outside, -way});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// f(edge, balance) for each edge and label.
template <class F>
void each_balance(const std::vector<LabelledEdge>& edges, F&& f) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    int balance = 0;
    for (; j < edges.size() && !(edges[i] < edges[j]); ++j) balance += edges[j].way;
    f(edges[i], balance);
    i = j;
  }
}

}  // namespace

TileSeams find_label_seams(const LatticeMesh& mesh, const CellKey& tile, const PointFrame& frame) {
  const std::vector<LabelledEdge> edges = labelled_edges(mesh);
  std::vector<bool> used(mesh.positions.size()), open(mesh.positions.size());
  each_balance(edges, [&](const LabelledEdge& edge, int balance) {
    used[edge.lo] = used[edge.hi] = true;
    if (balance != 0) open[edge.lo] = open[edge.hi] = true;
  });
  TileSeams out;
  std::vector<std::uint32_t> kept(mesh.positions.size(), PointIndex::none);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!used[v]) continue;
    const bool home = tile.cells().contains(frame.cell(mesh.positions[v]));
    if (home && !open[v]) {
      ++out.inner_vertices;
      continue;
    }
    kept[v] = static_cast<std::uint32_t>(out.points.size());
    out.points.push_back(mesh.positions[v]);
    out.home.push_back(home);
  }
  each_balance(edges, [&](const LabelledEdge& edge, int balance) {
    if (balance != 0)
      out.label_edges.push_back({kept[edge.lo], kept[edge.hi], edge.label, balance});
  });
  return out;
}

std::uint64_t drop_degenerate(LatticeMesh& mesh) {
  if (mesh.pairs.empty()) return std::erase_if(mesh.triangles, is_degenerate);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (is_degenerate(mesh.triangles[i])) continue;
    mesh.pairs[kept] = mesh.pairs[i];
    mesh.triangles[kept++] = mesh.triangles[i];
  }
  const std::size_t dropped = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  mesh.pairs.resize(kept);
  return dropped;
}

}  // namespace voxweld
