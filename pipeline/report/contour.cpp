// Based on: marching squares, the plane case of Lorensen and Cline, "Marching Cubes: A High
// Resolution 3D Surface Construction Algorithm" (1987). Where two corners across are inside, the
// mean of the four decides whether they hang together. Segments are chained to lines over the edges
// of the grid that they share.
#include "pipeline/report/contour.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace voxweld {
namespace {

// Corners and edges of a cell, rows rising:
//
//     3 ---2--- 2
//     |         |
//     3         1
//     |         |
//     0 ---0--- 1
//
// An edge of the grid is a point of a line where its ends differ. It has two cells at most, so at
// most two segments leave it.
class Tracer {
 public:
  Tracer(const Slice& slice, double isovalue, bool below)
      : slice_(slice), isovalue_(isovalue), below_(below) {
    columns_ = slice.columns.count;
    rows_ = slice.rows.count;
    links_.assign(static_cast<std::size_t>(2 * columns_ * rows_), {none, none});
    for (std::int64_t row = 0; row + 1 < rows_; ++row)
      for (std::int64_t column = 0; column + 1 < columns_; ++column) add_cell(column, row);
  }

  std::vector<ContourLine> lines() {
    std::vector<ContourLine> all;
    // Lines that end at the slice's edge begin there; what is left are rings.
    for (const bool rings : {false, true})
      for (std::size_t edge = 0; edge < links_.size(); ++edge)
        if (links_[edge][0] != none && (rings || links_[edge][1] == none))
          all.push_back(follow(static_cast<std::int64_t>(edge)));
    return all;
  }

 private:
  static constexpr std::int64_t none = -1;

  double value(std::int64_t column, std::int64_t row) const {
    return slice_.values[slice_.place(column, row)];
  }
  bool inside(double value) const { return below_ ? value < isovalue_ : value > isovalue_; }

  // Even: from a sample to the next of its row; odd: to the one above it.
  std::int64_t edge_of_cell(std::int64_t column, std::int64_t row, int edge) const {
    const std::int64_t sample = row * columns_ + column;
    switch (edge) {
      case 0:
        return 2 * sample;
      case 1:
        return 2 * (sample + 1) + 1;
      case 2:
        return 2 * (sample + columns_);
      default:
        return 2 * sample + 1;
    }
  }

  void join(std::int64_t a, std::int64_t b) {
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      auto& link = links_[static_cast<std::size_t>(from)];
      (link[0] == none ? link[0] : link[1]) = to;
    }
  }

  void add_cell(std::int64_t column, std::int64_t row) {
    const std::array<double, 4> corner = {value(column, row), value(column + 1, row),
                                          value(column + 1, row + 1), value(column, row + 1)};
    std::array<int, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (inside(corner[i]) != inside(corner[(i + 1) % 4])) crossed[count++] = static_cast<int>(i);
    const auto edge = [&](std::size_t i) { return edge_of_cell(column, row, crossed[i]); };
    if (count == 2) join(edge(0), edge(1));
    if (count < 4) return;
    const bool middle = inside((corner[0] + corner[1] + corner[2] + corner[3]) / 4);
    // The lines cut off the corners that the middle is not like.
    if (middle == inside(corner[0])) {
      join(edge(0), edge(1));
      join(edge(2), edge(3));
    } else {
      join(edge(3), edge(0));
      join(edge(1), edge(2));
    }
  }

  ContourPoint point(std::int64_t edge) const {
    const std::int64_t column = edge / 2 % columns_, row = edge / 2 / columns_;
    const bool upward = edge % 2 != 0;
    const double a = value(column, row);
    const double b = upward ? value(column, row + 1) : value(column + 1, row);
    const double share = (isovalue_ - a) / (b - a);
    const double t = share >= 0 && share <= 1 ? share : 0.5;  // NaN and infinities
    return {static_cast<double>(column) + (upward ? 0 : t),
            static_cast<double>(row) + (upward ? t : 0)};
  }

  ContourLine follow(std::int64_t begin) {
    ContourLine line;
    for (std::int64_t at = begin; at != none;) {
      line.points.push_back(point(at));
      auto& link = links_[static_cast<std::size_t>(at)];
      const std::int64_t next = link[0];
      link = {none, none};
      // Of a ring the last point leads to the first, which has no links left.
      line.closed = next != none && !forget(next, at);
      at = line.closed ? none : next;
    }
    return line;
  }

  // Takes the way back away; false where there is none.
  bool forget(std::int64_t edge, std::int64_t neighbour) {
    auto& link = links_[static_cast<std::size_t>(edge)];
    if (link[0] != neighbour && link[1] != neighbour) return false;
    link = {link[0] == neighbour ? link[1] : link[0], none};
    return true;
  }

  const Slice& slice_;
  double isovalue_;
  bool below_;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::array<std::int64_t, 2>> links_;  // of each edge, the edges it is joined to
};

}  // namespace

std::vector<ContourLine> contour_of(const Slice& slice, double isovalue, bool below) {
  return Tracer(slice, isovalue, below).lines();
}

std::size_t points_of(const std::vector<ContourLine>& lines) {
  std::size_t points = 0;
  for (const ContourLine& line : lines) points += line.points.size();
  return points;
}

std::string contour_path(const std::vector<ContourLine>& lines, const Slice& slice) {
  const double height = static_cast<double>(slice.rows.count);
  std::string path;
  for (const ContourLine& line : lines) {
    std::int64_t last_x = 0, last_y = 0;
    bool first = true;
    for (const ContourPoint& p : line.points) {
      const std::int64_t x = std::llround(10 * (p.x + 0.5));
      const std::int64_t y = std::llround(10 * (height - 0.5 - p.y));
      if (!first && x == last_x && y == last_y) continue;
      path += first ? fmt::format("M{} {}", x, y) : fmt::format("l{} {}", x - last_x, y - last_y);
      first = false;
      last_x = x;
      last_y = y;
    }
    if (line.closed) path += 'z';
  }
  return path;
}

}  // namespace voxweld
