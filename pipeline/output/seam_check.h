// The seams of all tiles put together: every edge used once each way, every vertex in one fan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "pipeline/output/tile_check.h"
#include "pipeline/output/verify.h"

namespace voxweld {

std::string tile_name(const CellKey& tile);  // "tile 5/1,0,2": level and position
// In place of a tile where the mesh is in one piece: holds every cell.
inline constexpr CellKey whole_mesh{max_levels, {}};

struct SeamRules {
  bool open_border = false;    // boundary edges may lie on the border
  bool free_topology = false;  // edges balanced, and nothing said about vertices
  bool labels = false;         // each label's edges balanced, and nothing said about vertices
  std::optional<Material> label = {};  // whose tiles these are, for messages
};

class SeamCheck {
 public:
  using Report = std::function<void(Problem)>;

  SeamCheck(const PointFrame& frame, const SeamRules& rules) : frame_(frame), rules_(rules) {}

  // Tiles in any order; what is reported is ordered as they are given.
  void add(const CellKey& tile, const TileSeams& seams);

  std::uint64_t vertices() const { return inner_vertices_ + index_.points().size(); }
  std::uint64_t seam_vertices() const;
  std::uint64_t boundary_edges() const { return boundary_edges_; }

  // Points kept by a tile in whose cube they do not lie and not kept by the tile in whose cube they
  // do, by that tile's name: if that tile has them all the same, they are surrounded there and
  // used elsewhere too.
  std::unordered_map<std::string, std::vector<LatticePoint>> doubtful() const;

  // After the last tile: compares all edges and fans.
  void finish(const Report& report);

 private:
  struct HalfEdge {
    std::uint32_t lo, hi;  // the ends in order
    std::uint32_t tile : 31;
    std::uint32_t reversed : 1;
  };
  struct KeptPoint {
    std::uint32_t first_tile;
    bool at_home = false, shared = false;
  };
  std::string place(std::uint32_t tile, std::uint32_t point) const;
  void add_points(std::uint32_t tile, const TileSeams& seams, std::vector<std::uint32_t>& number);
  struct SeamLabelEdge {
    std::uint32_t lo, hi;
    Material label;
    std::uint32_t tile;
    int balance;
  };
  void add_label_edges(std::uint32_t tile, const TileSeams& seams,
                       const std::vector<std::uint32_t>& number);
  void check_label_edges(const Report& report);
  void check_edges(const Report& report);
  void check_edge(const HalfEdge* first, const HalfEdge* last, const Report& report);
  void check_vertices(const Report& report);
  bool is_manifold(const SeamFan* first, const SeamFan* last) const;

  const PointFrame& frame_;
  const SeamRules rules_;
  std::vector<CellKey> tiles_;
  PointIndex index_;
  std::vector<KeptPoint> kept_;
  std::vector<HalfEdge> half_edges_;
  std::vector<SeamFan> fans_;
  std::vector<SeamLabelEdge> label_edges_;
  std::uint64_t inner_vertices_ = 0, boundary_edges_ = 0;
};

}  // namespace voxweld
