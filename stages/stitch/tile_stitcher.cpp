#include "stages/stitch/tile_stitcher.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "stages/contouring/cell_topology.h"
#include "stages/contouring/normal_clusters.h"
#include "stages/stitch/quad_split.h"

namespace voxweld {
namespace {

constexpr std::uint32_t unset = 0xffffffffu;

std::string name(CellKey key) {
  return fmt::format("level {} at ({}, {}, {})", key.level, key.at.x, key.at.y, key.at.z);
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(order.size());
  for (const std::uint32_t from : order) sorted.push_back(values[from]);
  values = std::move(sorted);
}

std::uint32_t sheet_of(const GhostLayer& ghost, const GhostCell& cell, int edge) {
  if (ghost.sheets_of_edges.empty())
    return cell_sheets(static_cast<CellSigns>(cell.signs()), cell.joined())
        .sheet_of_edge[static_cast<std::size_t>(edge)];
  return ghost.sheets_of_edges[static_cast<std::size_t>(&cell - ghost.cells.data())] >> (2 * edge) &
         3;
}

CellKey leaf_key(CellKey brick, LeafCode leaf) {
  const Index3 cell = brick.lo() + morton_decode(leaf.code());
  return {leaf.level(), {cell.x >> leaf.level(), cell.y >> leaf.level(), cell.z >> leaf.level()}};
}

}  // namespace

TileStitcher::TileStitcher(CellKey tile, const StitchParameters& parameters,
                           std::span<const TopLeaf> top, const AboveBricks* above)
    : parameters_(parameters), top_(top), above_(above) {
  mesh_.tile = tile;
  mesh_.lattice = moved(parameters.frame.lattice, parameters.first);
}

const TopLeaf* TileStitcher::leaf_above(CellKey brick) const {
  const std::uint64_t code = brick.code();
  auto after = std::upper_bound(top_.begin(), top_.end(), code,
                                [](std::uint64_t c, const TopLeaf& leaf) { return c < leaf.code; });
  if (after == top_.begin()) return nullptr;
  const TopLeaf& leaf = *--after;
  return code - leaf.code < std::uint64_t{1} << (3 * leaf.level) ? &leaf : nullptr;
}

void TileStitcher::add(const StitchBrick& brick) {
  local_.assign(brick.vertices.size(), unset);
  in_own_layer_.assign(brick.vertices.size(), 0);
  for (const GhostVertex& v : brick.own_layer->vertices) in_own_layer_[v.brick_vertex] = 1;
  brick_above_ = brick.vertices.size() == 1 ? leaf_above(brick.key) : nullptr;
  for (std::size_t i = 0; i < brick.polygons.size(); ++i) {
    std::array<std::uint32_t, 4> corners;
    int smallest = max_levels;
    for (std::size_t k = 0; k < 4; ++k) {
      const CornerRef ref = brick.polygons[i][k];
      const Corner corner =
          ref.is_foreign() ? foreign_corner(brick, ref) : local_corner(brick, ref.vertex());
      corners[k] = corner.index;
      smallest = std::min(smallest, corner.level);
    }
    if (!brick.emit_levels.empty() && (brick.emit_levels[i] >> smallest & 1) == 0) continue;
    add_polygon(corners);
    if (!brick.polygon_pairs.empty()) note_pair(brick.pairs[brick.polygon_pairs[i]]);
  }
}

// Of the triangles made since the last.
void TileStitcher::note_pair(const MaterialPair& pair) {
  if (mesh_.triangle_pairs.size() == mesh_.triangles.size()) return;
  const auto [at, is_new] =
      pairs_.try_emplace(pair, static_cast<std::uint32_t>(mesh_.pairs.size()));
  if (is_new) mesh_.pairs.push_back(pair);
  mesh_.triangle_pairs.resize(mesh_.triangles.size(), at->second);
}

void TileStitcher::sort_pairs() {
  std::vector<std::uint32_t> place(mesh_.pairs.size());
  std::uint32_t next = 0;
  for (const auto& [pair, met] : pairs_) {
    place[met] = next;
    mesh_.pairs[next++] = pair;
  }
  for (std::uint32_t& pair : mesh_.triangle_pairs) pair = place[pair];
}

TileStitcher::Corner TileStitcher::local_corner(const StitchBrick& brick, std::uint32_t vertex) {
  const LeafVertex& v = brick.vertices[vertex];
  if (!brick.roots.empty()) {
    if (local_[vertex] == unset) {
      local_[vertex] = sheet_vertex(
          brick.key, brick.roots, vertex,
          [&](std::size_t i) -> const LeafVertex& { return brick.vertices[i]; },
          in_own_layer_[vertex] != 0);
    }
    return {local_[vertex], 0};
  }
  if (local_[vertex] != unset)
    return {local_[vertex],
            brick_above_ != nullptr ? static_cast<int>(brick_above_->level) : v.leaf.level()};
  const auto sheet = static_cast<std::size_t>(v.leaf.sheet());
  const auto group = brick.vertices.subspan(vertex - sheet, sheet + 1);
  Corner corner{};
  if (in_own_layer_[vertex] != 0 || brick_above_ != nullptr) {
    corner = shared_vertex(brick.key, group);
  } else {
    const CellKey leaf = leaf_key(brick.key, v.leaf);
    const LatticePoint point = sheet == 0 ? snap_vertex(parameters_.frame, leaf, v.offset)
                                          : snap_sheets(parameters_.frame, leaf, group);
    corner = {append(VertexId::make(leaf, v.leaf.sheet()), point, v), leaf.level};
  }
  local_[vertex] = corner.index;
  return corner;
}

TileStitcher::Corner TileStitcher::foreign_corner(const StitchBrick& brick, CornerRef ref) {
  const int d = ref.direction();
  const CellKey neighbour{brick.key.level, brick.key.at + Index3{d & 1, d >> 1 & 1, d >> 2}};
  const GhostLayer* ghost = brick.upper[static_cast<std::size_t>(d)];
  const auto fail = [&](const char* what) {
    throw std::logic_error(
        fmt::format("stitch: brick {} refers to cell {:#x} of brick {}, which {}", name(brick.key),
                    ref.code(), name(neighbour), what));
  };
  if (ghost == nullptr) fail("has no ghost layer");
  const auto cell =
      std::lower_bound(ghost->cells.begin(), ghost->cells.end(), ref.code(),
                       [](const GhostCell& c, std::uint32_t code) { return c.code() < code; });
  if (cell == ghost->cells.end() || cell->code() != ref.code()) fail("is not active there");
  const std::uint32_t first = cell->first();
  std::uint32_t sheet = 0;
  if (!ghost->roots.empty()) {
    const CellSheets& sheets = cell_sheets(static_cast<CellSigns>(cell->signs()), cell->joined());
    sheet = sheets.sheet_of_edge[static_cast<std::size_t>(ref.edge())];
    if (sheet > 3) fail("has no crossing on that edge");
    const std::uint32_t vertex = sheets.sheets == 1 ? first : ghost->apart[first + sheet];
    const auto vertex_at = [&](std::size_t i) -> const LeafVertex& {
      return ghost->vertices[i].vertex;
    };
    return {sheet_vertex(neighbour, ghost->roots, vertex, vertex_at, true), 0};
  }
  if (ghost->vertices[first].vertex.leaf.level() == 0) sheet = sheet_of(*ghost, *cell, ref.edge());
  if (sheet > 3) fail("has no crossing on that edge");
  group_.clear();
  for (std::uint32_t s = 0; s <= sheet; ++s) group_.push_back(ghost->vertices[first + s].vertex);
  return shared_vertex(neighbour, group_);
}

// The vertex above the brick that has taken in what goes to this one of the brick's clusters.
const ClusterLeaf* TileStitcher::sheet_above(const BrickAbove* around, std::uint8_t root) const {
  if (around == nullptr || root == BrickOctree::no_root) return nullptr;
  const std::uint32_t link = above_->links[around->first_link + root];
  return link == no_cluster ? nullptr : &above_->leaves[link];
}

// The vertex that a brick's vertex has become. vertex_at: as a brick or a ghost layer has them, and
// roots beside them. is_shared: other bricks may refer to it.
template <class VertexAt>
std::uint32_t TileStitcher::sheet_vertex(CellKey brick, std::span<const std::uint8_t> roots,
                                         std::size_t vertex, const VertexAt& vertex_at,
                                         bool is_shared) {
  const LeafVertex& own = vertex_at(vertex);
  const BrickAbove* around = above_ == nullptr ? nullptr : above_->find(brick.code());
  const ClusterLeaf* above = sheet_above(around, roots[vertex]);
  const VertexId id =
      above != nullptr
          ? VertexId::make(static_cast<int>(above->level), above->first.code(),
                           above->first.sheet())
          : VertexId::make(own.leaf.level(), brick.code() + own.leaf.code(), own.leaf.sheet());
  is_shared = is_shared || above != nullptr;
  if (is_shared)
    if (const auto found = shared_.find(id.bits); found != shared_.end()) return found->second;
  bool shares = own.leaf.shares() || (around != nullptr && around->covered != 0);
  // With those before it that are of the same node.
  offsets_.clear();
  if (above != nullptr) {
    shares = above->shares != 0;
    const ClusterLeaf* first = above;
    while (first != above_->leaves.data() && (first - 1)->level == above->level &&
           (first - 1)->key() == above->key())
      --first;
    for (; first <= above; ++first) offsets_.push_back(first->vertex.offset);
  } else {
    std::size_t first = vertex;
    while (first > 0 && vertex_at(first - 1).leaf.same_node(own.leaf)) --first;
    // What a vertex above the brick has taken in is none: a larger brick would not have it either.
    for (; first <= vertex; ++first)
      if (sheet_above(around, roots[first]) == nullptr) offsets_.push_back(vertex_at(first).offset);
  }
  const LatticePoint point = snap_in_group(parameters_.frame, id.leaf(), shares, offsets_);
  const std::uint32_t index = append(id, point, above != nullptr ? above->vertex : own);
  if (is_shared) shared_.emplace(id.bits, index);
  return index;
}

// group: the sheets of one leaf up to the one wanted.
TileStitcher::Corner TileStitcher::shared_vertex(CellKey brick, std::span<const LeafVertex> group) {
  const LeafVertex& v = group.back();
  CellKey leaf = leaf_key(brick, v.leaf);
  const TopLeaf* above = leaf.level == brick.level ? leaf_above(brick) : nullptr;
  if (above != nullptr) leaf = above->key();
  const VertexId id = VertexId::make(leaf, v.leaf.sheet());
  const auto found = shared_.find(id.bits);
  if (found != shared_.end()) return {found->second, leaf.level};
  const LeafVertex& source = above != nullptr ? above->vertex : v;
  const LatticePoint point = group.size() == 1 ? snap_vertex(parameters_.frame, leaf, source.offset)
                                               : snap_sheets(parameters_.frame, leaf, group);
  const std::uint32_t index = append(id, point, source);
  shared_.emplace(id.bits, index);
  return {index, leaf.level};
}

std::uint32_t TileStitcher::append(VertexId id, const LatticePoint& point,
                                   const LeafVertex& vertex) {
  const auto index = static_cast<std::uint32_t>(mesh_.positions.size());
  mesh_.positions.push_back(point);
  mesh_.ids.push_back(id);
  if (parameters_.aims) mesh_.aims.push_back(point_of(parameters_.frame, id.leaf(), vertex.offset));
  mesh_.normals.push_back(vertex.normals);
  senses_.push_back(vertex.leaf.sense());
  return index;
}

void TileStitcher::add_polygon(std::array<std::uint32_t, 4> corners) {
  std::size_t count = 0;
  std::array<std::uint32_t, 4> distinct{};
  for (std::size_t k = 0; k < 4; ++k)
    if (corners[k] != corners[(k + 3) % 4]) distinct[count++] = corners[k];
  if (count < 3) return;
  if (count == 3) {
    ++mesh_.polygon_triangles;
    add_triangle(distinct[0], distinct[1], distinct[2]);
    return;
  }
  ++mesh_.quads;
  std::array<QuadCorner, 4> quad;
  for (std::size_t k = 0; k < 4; ++k)
    quad[k] = {mesh_.positions[corners[k]], mesh_.ids[corners[k]], mesh_.normals[corners[k]],
               senses_[corners[k]]};
  if (cut_from_one(quad)) {
    add_triangle(corners[1], corners[2], corners[3]);
    add_triangle(corners[1], corners[3], corners[0]);
  } else {
    add_triangle(corners[0], corners[1], corners[2]);
    add_triangle(corners[0], corners[2], corners[3]);
  }
}

void TileStitcher::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_.triangles.push_back({a, b, c});
  if (!parameters_.triangle_notes) return;
  const Vec3 area = area_vector(mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]);
  if (area == Vec3{}) ++mesh_.collinear;
  if (!parameters_.normals) return;
  const auto cluster = [&](std::uint32_t v) {
    return nearest_cluster(mesh_.normals[v], area, senses_[v]);
  };
  mesh_.corner_normals.push_back({cluster(a), cluster(b), cluster(c)});
}

// Polygons that turned out to have fewer than three leaves may have brought in vertices that
// nothing uses, or brought them in early, as the bricks happened to be cut: the order that counts
// is that of first use by a triangle.
TileMesh TileStitcher::finish() {
  sort_pairs();
  std::vector<std::uint32_t> number(mesh_.positions.size(), unset), order;
  order.reserve(number.size());
  for (auto& triangle : mesh_.triangles)
    for (std::uint32_t& corner : triangle) {
      if (number[corner] == unset) {
        number[corner] = static_cast<std::uint32_t>(order.size());
        order.push_back(corner);
      }
      corner = number[corner];
    }
  reorder(mesh_.positions, order);
  reorder(mesh_.ids, order);
  if (parameters_.aims) reorder(mesh_.aims, order);
  if (parameters_.normals)
    reorder(mesh_.normals, order);
  else
    mesh_.normals = {};
  return std::move(mesh_);
}

std::uint64_t stitch_bytes(std::uint64_t vertices, std::uint64_t polygons) {
  // Position, id, normals and their sense of a vertex; two triangles with clusters of a polygon;
  // vectors may have grown to twice their content, and hold old and new while they grow.
  return vertices * 3 * (12 + 8 + 12 + 4) + polygons * 3 * 2 * (12 + 3) + vertices / 4 * 48;
}

}  // namespace voxweld
