#include "tests/paper/extrusion.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "storage/support/file_io.h"

namespace voxweld::paper {

bool holds(const Outline& outline, Point2 p) {
  bool inside = false;
  for (const Contour& contour : outline)
    for (std::size_t i = 0; i < contour.size(); ++i) {
      const Point2 a = contour[i], b = contour[(i + 1) % contour.size()];
      if ((a[1] > p[1]) == (b[1] > p[1])) continue;
      if (p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
    }
  return inside;
}

Contour regular_polygon(int sides, double radius) {
  Contour polygon;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    polygon.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return polygon;
}

namespace {

double area_within(const Outline& outline) {
  double twice = 0;
  for (const Contour& contour : outline)
    for (std::size_t i = 0; i < contour.size(); ++i) {
      const Point2 a = contour[i], b = contour[(i + 1) % contour.size()];
      twice += a[0] * b[1] - a[1] * b[0];
    }
  return twice / 2;
}

}  // namespace

TriangleMesh extrude(const Outline& outline, double low, double high, const Frame3& frame) {
  TriangleMesh mesh;
  for (const Contour& contour : outline) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto n = static_cast<std::uint32_t>(contour.size());
    for (const double level : {low, high})
      for (const Point2& p : contour) mesh.vertices.push_back(frame.place({p[0], p[1], level}));
    const auto bottom = [&](std::uint32_t i) { return first + i % n; };
    const auto top = [&](std::uint32_t i) { return first + n + i % n; };
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({bottom(i), bottom(i + 1), top(i + 1)});
      mesh.triangles.push_back({bottom(i), top(i + 1), top(i)});
      if (i == 0 || i + 1 == n) continue;
      mesh.triangles.push_back({bottom(0), bottom(i + 1), bottom(i)});
      mesh.triangles.push_back({top(0), top(i), top(i + 1)});
    }
  }
  // Outlines whose outer contours run clockwise, as those of TrueType fonts do.
  if (area_within(outline) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

void write_off(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  write_whole_file(path, as_bytes(text), Durability::rename_only);
}

}  // namespace voxweld::paper
