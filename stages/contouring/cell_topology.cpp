#include "stages/contouring/cell_topology.h"

#include <algorithm>

#include "stages/contouring/crossing_sets.h"

namespace voxweld {
namespace {

constexpr int bit_at(unsigned mask, int i) {
  return static_cast<int>(mask >> i & 1u);
}

constexpr bool crosses(CellSigns signs, int edge) {
  const EdgeCorners ends = edge_corners(edge);
  return bit_at(signs, ends.low) != bit_at(signs, ends.high);
}

constexpr bool ambiguous(CellSigns signs, int face) {
  const auto c = face_corners(face);
  return bit_at(signs, c[0]) == bit_at(signs, c[2]) && bit_at(signs, c[1]) == bit_at(signs, c[3]) &&
         bit_at(signs, c[0]) != bit_at(signs, c[1]);
}

// Joins the crossings of one face by its arcs. On an ambiguous face an arc goes around each inside
// corner (so that they are separated), or around each outside corner when `joined`.
constexpr void join_arcs(CellSigns signs, int face, bool joined, CrossingSets& loops) {
  const auto c = face_corners(face);
  if (ambiguous(signs, face)) {
    for (std::size_t i = 0; i < 4; ++i)
      if (bit_at(signs, c[i]) != static_cast<int>(joined)) loops.join_around(c, i);
    return;
  }
  int first = -1;
  for (std::size_t i = 0; i < 4; ++i) {
    const int edge = edge_between(c[i], c[(i + 1) % 4]);
    if (!crosses(signs, edge)) continue;
    if (first >= 0) loops.join(first, edge);
    first = edge;
  }
}

constexpr CellSheets make_sheets(CellSigns signs, int joined_face) {
  CrossingSets loops;
  for (int face = 0; face < 6; ++face) join_arcs(signs, face, face == joined_face, loops);
  return loops.sheets([&](int edge) { return crosses(signs, edge); });
}

constexpr int find_problem_face(CellSigns signs, const CellSheets& cell) {
  for (int face = 0; face < 6; ++face) {
    if (!ambiguous(signs, face)) continue;
    const auto c = face_corners(face);
    bool one = true;
    const auto sheet = cell.sheet_of_edge[static_cast<std::size_t>(edge_between(c[0], c[1]))];
    for (std::size_t i = 1; i < 4; ++i)
      one =
          one &&
          cell.sheet_of_edge[static_cast<std::size_t>(edge_between(c[i], c[(i + 1) % 4]))] == sheet;
    if (one) return face;
  }
  return -1;
}

topology_detail::Tables make_tables() {
  topology_detail::Tables tables;
  for (unsigned s = 0; s < 256; ++s) {
    const auto signs = static_cast<CellSigns>(s);
    tables.sheets[0][s] = make_sheets(signs, -1);
    const int face = find_problem_face(signs, tables.sheets[0][s]);
    tables.problem_face[s] = static_cast<std::int8_t>(face);
    tables.sheets[1][s] = face < 0 ? tables.sheets[0][s] : make_sheets(signs, face);
    tables.most_sheets[s] = std::max(tables.sheets[0][s].sheets, tables.sheets[1][s].sheets);
    tables.collapsible[s] = s != 0 && s != 255 && one_component(s) && one_component(~s & 255u);
  }
  return tables;
}

}  // namespace

namespace topology_detail {
const Tables tables = make_tables();
}

CellSigns corners_of_signs27(std::uint32_t s) {
  unsigned corners = 0;
  for (int i = 0; i < 8; ++i)
    corners |= (s >> (2 * (i & 1) + 6 * (i >> 1 & 1) + 18 * (i >> 2)) & 1u) << i;
  return static_cast<CellSigns>(corners);
}

std::uint32_t gather_signs27(const std::array<CellSigns, 8>& children) {
  std::uint32_t signs = 0;
  for (int child = 0; child < 8; ++child)
    for (int corner = 0; corner < 8; ++corner) {
      const int x = (child & 1) + (corner & 1), y = (child >> 1 & 1) + (corner >> 1 & 1),
                z = (child >> 2) + (corner >> 2);
      const auto sign =
          static_cast<std::uint32_t>(children[static_cast<std::size_t>(child)] >> corner & 1);
      signs |= sign << (x + 3 * y + 9 * z);
    }
  return signs;
}

bool signs_allow_collapse(std::uint32_t s) {
  if (!collapsible(corners_of_signs27(s))) return false;
  constexpr std::array<int, 3> stride = {1, 3, 9};
  for (std::size_t a = 0; a < 3; ++a) {
    const int da = stride[a], db = stride[(a + 1) % 3], dc = stride[(a + 2) % 3];
    for (const int b : {0, 2 * db})
      for (const int c : {0, 2 * dc}) {  // an edge's middle against its ends
        const int low = b + c;
        if (bit_at(s, low) == bit_at(s, low + 2 * da) && bit_at(s, low + da) != bit_at(s, low))
          return false;
      }
    for (const int c : {0, 2 * dc}) {  // a face's middle against its corners (axes a and b)
      const int sum = bit_at(s, c) + bit_at(s, c + 2 * da) + bit_at(s, c + 2 * db) +
                      bit_at(s, c + 2 * da + 2 * db);
      const int middle = bit_at(s, c + da + db);
      if ((sum == 0 && middle == 1) || (sum == 4 && middle == 0)) return false;
    }
  }
  return true;  // the corners differ, so the centre agrees with one of them
}

}  // namespace voxweld
