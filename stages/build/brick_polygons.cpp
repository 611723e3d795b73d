#include "stages/build/brick_polygons.h"

#include <algorithm>
#include <unordered_map>

namespace voxweld {
namespace {

class PolygonEmitter {
 public:
  PolygonEmitter(const BrickFrame& frame, Index3 volume_size, const ActiveCells& cells,
                 const BrickLeaves& leaves, const ContourParameters& parameters, BrickOctree& out)
      : frame_(frame),
        size_(volume_size),
        cells_(cells),
        leaves_(leaves),
        open_(parameters.surface.border == Border::open),
        free_(parameters.simplify.topology == Topology::free && parameters.simplify.enabled),
        out_(out) {}

  void emit_all(const SignGrid& signs) {
    signs_ = &signs;
    each_last_edge([&](const Owner& owner, int axis, int low) {
      const unsigned s = cells_.signs(owner.cell);
      if ((s >> 7 & 1u) != (s >> low & 1u)) emit(owner, axis, (s >> low & 1u) != 0);
    });
  }

  void emit_all(const LabelGrid& labels) {
    each_last_edge([&](const Owner& owner, int axis, int low) {
      const LocalCell& c = owner.at;
      const std::uint32_t at_low =
          labels.at(c.x + (low & 1), c.y + (low >> 1 & 1), c.z + (low >> 2));
      const std::uint32_t at_high = labels.at(c.x + 1, c.y + 1, c.z + 1);
      if (at_low == at_high || !emit(owner, axis, at_low < at_high)) return;
      const auto [inside, outside] = std::minmax(at_low, at_high);
      const auto [pair, is_new] = pairs_.try_emplace(std::uint64_t{inside} << 32 | outside,
                                                     static_cast<std::uint32_t>(pairs_.size()));
      if (is_new) out_.pairs.push_back({labels.materials()[inside], labels.materials()[outside]});
      out_.polygon_pairs.push_back(pair->second);
    });
  }

 private:
  // The lowest of an edge's four cells.
  struct Owner {
    std::size_t cell = 0;
    LocalCell at;
    // In its leaf: one less than the leaf's side; 0 also where the cell is of several leaves.
    int last = 0;

    // Whether all cells around its last edge along an axis that is neither b nor c are of its leaf. Their
    // sheets meet in the edge, so they are of one cluster, and have one vertex.
    bool is_within_leaf(int b, int c) const {
      return (at[b] & last) != last && (at[c] & last) != last;
    }
  };
  Owner owner_of(std::size_t cell) const {
    const std::uint32_t first = leaves_.first_vertex(cell);
    const bool apart = (first & BrickLeaves::apart) != 0;
    return {cell, cells_.at(cell), apart ? 0 : (1 << out_.vertices[first].leaf.level()) - 1};
  }

  // f(owner, axis, low corner) of every cell's last edges.
  template <class F>
  void each_last_edge(F&& f) {
    std::size_t block = 0;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const std::size_t of_cell = cells_.code(i) >> (3 * block_level);
      for (; block < of_cell; ++block) close_block(block);
      const Owner owner = owner_of(i);
      for (int axis = 0; axis < 3; ++axis) f(owner, axis, 7 ^ 1 << axis);
    }
    for (; block < out_.blocks.size(); ++block) close_block(block);
  }

  void close_block(std::size_t block) {
    out_.blocks[block].polygon_end = static_cast<std::uint32_t>(out_.polygons.size());
  }

  // The cells around an edge along `axis`, from the owner, counter-clockwise seen from its high
  // end:
  //   3 2   c = axis + 2
  //   0 1   b = axis + 1 to the right, c up
  // Whether it made a polygon.
  bool emit(const Owner& owner, int axis, bool low_inside) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    ++out_.counts.crossing_edges;
    if (owner.is_within_leaf(b, c)) return false;
    if (open_ && ends_in_ring(owner.at, axis)) return false;
    const unsigned around[4] = {0, 1u << b, 1u << b | 1u << c, 1u << c};
    PolygonRefs refs;
    for (std::size_t k = 0; k < 4; ++k) {
      // In the cell at this offset the edge's low corner is what remains to (b, c) = (1, 1).
      const int corner = (1 << b | 1 << c) & ~static_cast<int>(around[k]);
      refs[k] = corner_ref(owner.cell, around[k], edge_at(axis, corner));
    }
    if (!low_inside) std::swap(refs[1], refs[3]);
    if (!may_be_polygon(refs)) return false;
    if (free_) {
      const std::uint8_t levels = emit_levels(owner.at, axis);
      if (all_local(refs) && (levels >> smallest_level(refs) & 1) == 0) return false;
      out_.emit_levels.push_back(levels);
    }
    out_.polygons.push_back(refs);
    return true;
  }

  CornerRef corner_ref(std::size_t owner, unsigned offset, int edge) const {
    if (offset == 0) return CornerRef::local(leaves_.vertex(cells_, owner, edge, out_));
    std::uint32_t code = cells_.code(owner);
    int direction = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if ((offset >> axis & 1u) == 0) continue;
      code = next_along(code, axis);
      const std::uint32_t inside = morton_axis_mask[axis] & ((1u << 3 * frame_.level) - 1);
      if ((code & inside) == 0) {  // past the brick's upper plane: first layer of the neighbour
        direction |= 1 << axis;
        code &= ~morton_axis_mask[axis];
      }
    }
    if (direction != 0) return CornerRef::foreign(direction, code, edge);
    return CornerRef::local(leaves_.vertex(cells_, cells_.index_of(code), edge, out_));
  }

  bool ends_in_ring(const LocalCell& at, int axis) const {
    const std::int64_t low = frame_.origin[axis] + at[axis];
    return low < 1 || low + 1 > size_[axis];
  }

  static bool all_local(const PolygonRefs& refs) {
    return std::none_of(refs.begin(), refs.end(), [](CornerRef r) { return r.is_foreign(); });
  }
  int smallest_level(const PolygonRefs& refs) const {
    int level = max_brick_level;
    for (const CornerRef ref : refs)
      level = std::min(level, out_.vertices[ref.vertex()].leaf.level());
    return level;
  }

  // Bit l: in the aligned segment of 2^l lattice edges around this one the ends differ and no
  // crossing comes before this one. Then, when the smallest leaf around is of level l, the segment
  // is a minimal edge with a sign change and this crossing speaks for it.
  std::uint8_t emit_levels(const LocalCell& at, int axis) const {
    unsigned levels = 0;
    for (int l = 0; l <= min_brick_level; ++l) {
      const int length = 1 << l, start = at[axis] & ~(length - 1);
      const bool first = point_inside(at, axis, start);
      bool alone = first != point_inside(at, axis, start + length);
      for (int p = start + 1; p <= at[axis] && alone; ++p)
        alone = point_inside(at, axis, p) == first;
      levels |= static_cast<unsigned>(alone) << l;
    }
    return static_cast<std::uint8_t>(levels);
  }
  // On the line of the edge: the lattice point at `along` on its axis.
  bool point_inside(const LocalCell& at, int axis, int along) const {
    return axis == 0   ? signs_->inside(along, at.y + 1, at.z + 1)
           : axis == 1 ? signs_->inside(at.x + 1, along, at.z + 1)
                       : signs_->inside(at.x + 1, at.y + 1, along);
  }

  const BrickFrame& frame_;
  Index3 size_;
  const SignGrid* signs_ = nullptr;
  const ActiveCells& cells_;
  const BrickLeaves& leaves_;
  bool open_, free_;
  std::unordered_map<std::uint64_t, std::uint32_t> pairs_;  // of labels: place in out_.pairs
  BrickOctree& out_;
};

std::uint32_t pack_sheets(const CellSheets& sheets) {
  std::uint32_t packed = 0;
  for (std::size_t e = 0; e < 12; ++e)
    packed |= (sheets.sheet_of_edge[e] & std::uint32_t{3}) << (2 * e);
  return packed;
}

}  // namespace

bool may_be_polygon(const PolygonRefs& refs) {
  int distinct = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (refs[k] != refs[(k + 1) % 4]) ++distinct;
  return distinct >= 3;
}

void emit_polygons(const BrickFrame& frame, Index3 volume_size, const SignGrid& signs,
                   const ActiveCells& cells, const BrickLeaves& leaves,
                   const ContourParameters& parameters, BrickOctree& out) {
  PolygonEmitter(frame, volume_size, cells, leaves, parameters, out).emit_all(signs);
}

void emit_polygons(const BrickFrame& frame, Index3 volume_size, const LabelGrid& labels,
                   const ActiveCells& cells, const BrickLeaves& leaves,
                   const ContourParameters& parameters, BrickOctree& out) {
  PolygonEmitter(frame, volume_size, cells, leaves, parameters, out).emit_all(labels);
}

namespace {

bool in_lowest_layer(std::uint32_t code) {
  return (code & morton_axis_mask[0]) == 0 || (code & morton_axis_mask[1]) == 0 ||
         (code & morton_axis_mask[2]) == 0;
}

// f(vertex) of each of the cell's sheets, in their order.
template <class F>
void each_sheet_vertex(const ActiveCells& cells, const BrickLeaves& leaves, std::size_t cell,
                       const F& f) {
  const std::uint32_t first = leaves.first_vertex(cell);
  if ((first & BrickLeaves::apart) == 0) return f(first);
  for (std::uint32_t s = 0; s < cells.sheets(cell).sheets; ++s)
    f(leaves.apart_vertices()[(first & ~BrickLeaves::apart) + s]);
}

}  // namespace

void add_ghost_vertices(std::vector<std::uint32_t>& marks, BrickOctree& out) {
  // Snapping one needs those before it that are of the same node.
  for (std::size_t v = out.vertices.size(); v-- > 1;)
    if (marks[v] != 0 && out.vertices[v].leaf.same_node(out.vertices[v - 1].leaf)) marks[v - 1] = 1;
  for (std::uint32_t v = 0; v < marks.size(); ++v) {
    if (marks[v] == 0) continue;
    marks[v] = static_cast<std::uint32_t>(out.ghost.vertices.size());
    out.ghost.vertices.push_back({v, out.vertices[v]});
    out.ghost.roots.push_back(out.roots[v]);
  }
}

void make_sheet_ghosts(const ActiveCells& cells, const BrickLeaves& leaves,
                       std::vector<std::uint32_t>& scratch, BrickOctree& out) {
  std::vector<std::uint32_t>& number = scratch;  // first 1 where it is wanted, then its number
  number.assign(out.vertices.size(), 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (in_lowest_layer(cells.code(i)))
      each_sheet_vertex(cells, leaves, i, [&](std::uint32_t v) { number[v] = 1; });
  add_ghost_vertices(number, out);
  GhostLayer& ghost = out.ghost;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t code = cells.code(i);
    if (!in_lowest_layer(code)) continue;
    const bool several = (leaves.first_vertex(i) & BrickLeaves::apart) != 0;
    const std::uint32_t first =
        several ? static_cast<std::uint32_t>(ghost.apart.size()) : number[leaves.first_vertex(i)];
    if (several)
      each_sheet_vertex(cells, leaves, i,
                        [&](std::uint32_t v) { ghost.apart.push_back(number[v]); });
    ghost.cells.push_back({code | static_cast<std::uint32_t>(cells.signs(i)) << 24,
                           first | static_cast<std::uint32_t>(cells.joined(i)) << 31});
  }
}

void make_ghost_layer(const ActiveCells& cells, const BrickLeaves& leaves, bool labels,
                      std::vector<std::uint32_t>& scratch, BrickOctree& out) {
  constexpr std::uint32_t unseen = 0xffffffffu;
  scratch.assign(out.vertices.size(), unseen);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t code = cells.code(i);
    if (!in_lowest_layer(code)) continue;
    const std::uint32_t first = leaves.first_vertex(i);
    if (scratch[first] == unseen) {
      scratch[first] = static_cast<std::uint32_t>(out.ghost.vertices.size());
      const bool own_leaf = out.vertices[first].leaf.level() == 0;
      const std::uint32_t sheets = own_leaf ? cells.sheets(i).sheets : 1;
      for (std::uint32_t s = 0; s < sheets; ++s)
        out.ghost.vertices.push_back({first + s, out.vertices[first + s]});
    }
    out.ghost.cells.push_back({code | static_cast<std::uint32_t>(cells.signs(i)) << 24,
                               scratch[first] | static_cast<std::uint32_t>(cells.joined(i)) << 31});
    if (labels) out.ghost.sheets_of_edges.push_back(pack_sheets(cells.sheets(i)));
  }
}

}  // namespace voxweld
