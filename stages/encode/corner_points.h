// The points that formats have which keep a normal or a pair of labels with each point: a vertex is as
// many as it has of those.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// One point for each (vertex, normal) pair that a corner uses, numbered by first use.
class CornerPoints {
 public:
  explicit CornerPoints(const TileMesh& mesh) {
    for (const auto& corners : mesh.corner_normals)
      for (const CornerNormal normal : corners)
        normals_ = std::max(normals_, std::size_t{normal.bits} + 1);
    point_.assign(mesh.positions.size() * normals_, no_point);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& point = point_[slot(mesh.triangles[i][k], mesh.corner_normals[i][k])];
        if (point == no_point) point = count_++;
      }
    }
  }
  std::uint32_t count() const { return count_; }
  std::uint32_t of(std::uint32_t vertex, CornerNormal normal) const {
    return point_[slot(vertex, normal)];
  }

  // f(point, vertex, normal)
  template <class F>
  void each(F&& f) const {
    for (std::size_t i = 0; i < point_.size(); ++i) {
      if (point_[i] == no_point) continue;
      f(point_[i], static_cast<std::uint32_t>(i / normals_),
        CornerNormal{static_cast<std::uint8_t>(i % normals_)});
    }
  }

 private:
  static constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();
  std::size_t slot(std::uint32_t vertex, CornerNormal normal) const {
    return vertex * normals_ + normal.bits;
  }
  std::size_t normals_ = 1;           // the most that a vertex may have, by their bits
  std::vector<std::uint32_t> point_;  // of each vertex and normal
  std::uint32_t count_ = 0;
};

// Of a mesh between labels: one point for each vertex, normal and pair that corners have together,
// numbered by first use. A vertex in which several pairs meet is as many points.
class PairPoints {
 public:
  struct Point {
    std::uint32_t vertex = 0, pair = 0;
    CornerNormal normal;
    friend bool operator==(const Point&, const Point&) = default;
  };
  PairPoints(const TileMesh& mesh, bool normals);
  const std::vector<Point>& points() const { return points_; }
  const std::vector<std::array<std::uint32_t, 3>>& corners() const { return corners_; }

 private:
  std::uint32_t number_of(const Point& point);

  static constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> first_;  // of each vertex
  std::vector<std::uint32_t> next_;   // the next point of the same vertex
  std::vector<Point> points_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
};

// The mesh's points as a format has them; without normals and pairs they are its vertices.
DecodedMesh corner_points(const TileMesh& mesh, bool normals);

}  // namespace voxweld
