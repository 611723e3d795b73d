#include "stages/contouring/label_topology.h"

#include <algorithm>

namespace voxweld {
namespace {

std::uint32_t at(const CellLabels& labels, int corner) {
  return labels[static_cast<std::size_t>(corner)];
}

// Sets of crossings, each named by its lowest edge.
struct EdgeSets {
  std::array<std::uint8_t, 12> parent{};
  EdgeSets() {
    for (std::size_t i = 0; i < 12; ++i) parent[i] = static_cast<std::uint8_t>(i);
  }
  std::size_t root(int edge) const {
    auto i = static_cast<std::size_t>(edge);
    while (parent[i] != i) i = parent[i];
    return i;
  }
  void join(int a, int b) {
    const std::size_t ra = root(a), rb = root(b);
    parent[std::max(ra, rb)] = static_cast<std::uint8_t>(std::min(ra, rb));
  }
};

// Where all four edges of a face cross, opposite corners may be of one label.
struct CrossedFace {
  bool first, second;  // corners 0 and 2 are; corners 1 and 3 are
};
CrossedFace crossed(const CellLabels& labels, const std::array<int, 4>& c) {
  return {at(labels, c[0]) == at(labels, c[2]), at(labels, c[1]) == at(labels, c[3])};
}

// Arcs around corners `from` and `from` + 2 of the face.
void join_around(const std::array<int, 4>& c, std::size_t from, EdgeSets& sets) {
  for (const std::size_t i : {from, from + 2})
    sets.join(edge_between(c[i], c[(i + 1) % 4]), edge_between(c[i], c[(i + 3) % 4]));
}

void join_face(const CellLabels& labels, int face, EdgeSets& sets) {
  const auto c = face_corners(face);
  std::array<int, 4> crossing{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (at(labels, c[i]) != at(labels, c[(i + 1) % 4]))
      crossing[count++] = edge_between(c[i], c[(i + 1) % 4]);
  if (count == 4) {
    const CrossedFace equal = crossed(labels, c);
    if (equal.first && equal.second)
      return join_around(c, at(labels, c[0]) < at(labels, c[1]) ? 0 : 1, sets);
    if (equal.first) return join_around(c, 1, sets);
    if (equal.second) return join_around(c, 0, sets);
  }
  for (std::size_t i = 1; i < count; ++i) sets.join(crossing[0], crossing[i]);
}

bool faces_are_simple(const CellLabels& labels) {
  for (int face = 0; face < 6; ++face) {
    const auto c = face_corners(face);
    bool all_cross = true;
    for (std::size_t i = 0; i < 4; ++i)
      all_cross = all_cross && at(labels, c[i]) != at(labels, c[(i + 1) % 4]);
    if (all_cross) return false;  // four labels, or one of them twice
  }
  return true;
}

// The corners of each label as a set of bits; more than four labels: count is 5.
struct LabelSets {
  std::array<unsigned, 5> corners{};
  std::array<std::uint32_t, 5> label{};
  std::size_t count = 0;
  explicit LabelSets(const CellLabels& labels) {
    for (std::size_t i = 0; i < 8 && count < 5; ++i) {
      std::size_t k = 0;
      while (k < count && label[k] != labels[i]) ++k;
      if (k == count) label[count++] = labels[i];
      corners[k] |= 1u << i;
    }
  }
};

// The corners one edge away from these.
constexpr unsigned neighbours(unsigned corners) {
  unsigned next = 0;
  for (unsigned i = 0; i < 8; ++i)
    if ((corners >> i & 1u) != 0) next |= 1u << (i ^ 1) | 1u << (i ^ 2) | 1u << (i ^ 4);
  return next;
}

bool one_component(unsigned corners) {
  unsigned reached = corners & (~corners + 1);
  for (unsigned before = 0; before != reached;) {
    before = reached;
    reached |= neighbours(reached) & corners;
  }
  return reached == corners;
}

}  // namespace

CellSheets label_sheets(const CellLabels& labels) {
  EdgeSets sets;
  for (int face = 0; face < 6; ++face) join_face(labels, face, sets);
  CellSheets cell;
  cell.sheet_of_edge.fill(255);
  for (int e = 0; e < 12; ++e) {
    const EdgeCorners ends = edge_corners(e);
    if (labels[ends.low] == labels[ends.high]) continue;
    cell.edges[cell.crossings++] = static_cast<std::uint8_t>(e);
    const std::size_t root = sets.root(e);
    if (cell.sheet_of_edge[root] == 255) cell.sheet_of_edge[root] = cell.sheets++;
    cell.sheet_of_edge[static_cast<std::size_t>(e)] = cell.sheet_of_edge[root];
  }
  return cell;
}

bool labels_collapsible(const CellLabels& labels) {
  const LabelSets sets(labels);
  if (sets.count < 2 || sets.count > 4 || !faces_are_simple(labels)) return false;
  for (std::size_t i = 0; i < sets.count; ++i) {
    if (!one_component(sets.corners[i])) return false;
    for (std::size_t j = i + 1; j < sets.count; ++j)
      if ((neighbours(sets.corners[i]) & sets.corners[j]) == 0) return false;
  }
  return true;
}

CellLabels corners_of_labels(const NodeLabels& labels) {
  CellLabels corners;
  for (std::size_t i = 0; i < 8; ++i)
    corners[i] = labels[2 * (i & 1) + 6 * (i >> 1 & 1) + 18 * (i >> 2)];
  return corners;
}

bool labels_allow_collapse(const NodeLabels& labels) {
  if (!labels_collapsible(corners_of_labels(labels))) return false;
  // Each point at half the side against the corners of the edge, face or cube it is the middle of:
  // along each axis where its place is 1, both ends.
  for (std::size_t i = 0; i < 27; ++i) {
    const std::size_t place[3] = {i % 3, i / 3 % 3, i / 9};
    bool any = false;
    for (std::size_t corner = 0; corner < 8 && !any; ++corner) {
      std::size_t end = 0, stride = 1;
      for (std::size_t a = 0; a < 3; ++a, stride *= 3)
        end += stride * (place[a] == 1 ? 2 * (corner >> a & 1) : place[a]);
      any = labels[end] == labels[i];
    }
    if (!any) return false;
  }
  return true;
}

}  // namespace voxweld
