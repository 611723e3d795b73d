#include "stages/contouring/label_topology.h"

#include "stages/contouring/crossing_sets.h"

namespace voxweld {
namespace {

std::uint32_t at(const CellLabels& labels, int corner) {
  return labels[static_cast<std::size_t>(corner)];
}

// Arcs around corners `from` and `from` + 2 of the face.
void join_around(const std::array<int, 4>& c, std::size_t from, CrossingSets& sets) {
  for (const std::size_t i : {from, from + 2}) sets.join_around(c, i);
}

void join_face(const CellLabels& labels, int face, CrossingSets& sets) {
  const auto c = face_corners(face);
  std::array<int, 4> crossing{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (at(labels, c[i]) != at(labels, c[(i + 1) % 4]))
      crossing[count++] = edge_between(c[i], c[(i + 1) % 4]);
  if (count == 4) {
    // Opposite corners may be of one label.
    const bool even = at(labels, c[0]) == at(labels, c[2]);
    const bool odd = at(labels, c[1]) == at(labels, c[3]);
    if (even && odd) return join_around(c, at(labels, c[0]) < at(labels, c[1]) ? 0 : 1, sets);
    if (even) return join_around(c, 1, sets);
    if (odd) return join_around(c, 0, sets);
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

}  // namespace

CellSheets label_sheets(const CellLabels& labels) {
  CrossingSets sets;
  for (int face = 0; face < 6; ++face) join_face(labels, face, sets);
  return sets.sheets([&](int edge) {
    const EdgeCorners ends = edge_corners(edge);
    return labels[ends.low] != labels[ends.high];
  });
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
