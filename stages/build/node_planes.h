// The planes of nodes of 2^3 cells, eight nodes at a time (plane_kernels.h).
#pragma once

#include <bit>
#include <optional>

#include "stages/build/active_cells.h"
#include "stages/build/collapse_rule.h"
#include "stages/build/hermite.h"
#include "stages/build/plane_kernels.h"
#include "stages/contouring/normal_clusters.h"

namespace voxweld {

class NodePlanes {
 public:
  explicit NodePlanes(Vec3 spacing) : spacing_(spacing), kernel_(plane_kernel()) {}

  // The edges of the node whose lowest cell is at c. Precondition: clear() since the lane was last
  // filled.
  void gather(std::size_t lane, LocalCell c, const NodeCrossings& crossings,
              const HermiteEdges& edges) {
    std::size_t k = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t rest = crossings[static_cast<std::size_t>(axis)]; rest != 0;
           rest &= rest - 1) {
        const int point = std::countr_zero(rest), x = point % 3, y = point / 3 % 3, z = point / 9;
        put(k++, lane, EdgePlace::make(axis, x, y, z), edges.at(axis, c.x + x, c.y + y, c.z + z));
      }
    edges_.rows = std::max(edges_.rows, k);
  }
  // Of what has been gathered.
  void compute(PlaneBatch& planes) {
    kernel_(edges_, spacing_, cluster_cosine, planes, directions_);
  }
  // The sum of a lane's normals where all are near it: compute() comes first.
  std::optional<NormalSum> direction(std::size_t lane, NormalSense sense) const {
    if (sense == NormalSense::either) return direction_of_either(lane);
    if (directions_.is_one[lane] == 0) return std::nullopt;
    NormalSum total;
    for (std::size_t a = 0; a < 3; ++a) total[a] = directions_.total[a][lane];
    return total;
  }
  void clear() {
    for (std::size_t k = 0; k < edges_.rows; ++k) edges_.row[k].place.fill(EdgePlace::none);
    edges_.rows = 0;
  }

 private:
  void put(std::size_t k, std::size_t lane, std::int32_t place, const HermiteEdge& edge) {
    NodeEdges::Row& row = edges_.row[k];
    row.place[lane] = place;
    row.edge[0][lane] = edge.t;
    for (std::size_t a = 0; a < 3; ++a) row.edge[a + 1][lane] = edge.normal[a];
  }
  // As one_direction.
  std::optional<NormalSum> direction_of_either(std::size_t lane) const {
    std::array<NormalSum, max_planes> normals;
    std::size_t count = 0;
    for (std::size_t k = 0; k < edges_.rows; ++k) {
      const NodeEdges::Row& row = edges_.row[k];
      const std::int32_t place = row.place[lane];
      if (place == EdgePlace::none) break;
      const auto weight = static_cast<float>(EdgePlace::cells(place));
      for (std::size_t a = 0; a < 3; ++a) normals[count][a] = weight * row.edge[a + 1][lane];
      ++count;
    }
    return one_direction({normals.data(), count}, NormalSense::either);
  }

  Vec3 spacing_;
  PlaneKernel kernel_;
  NodeEdges edges_;
  NodeDirections directions_;
};

}  // namespace voxweld
