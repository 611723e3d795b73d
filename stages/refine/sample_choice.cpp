#include "stages/refine/sample_choice.h"

#include <algorithm>
#include <cmath>

#include "stages/refine/nearest_triangle.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

using Samples = std::vector<SurfaceSample>;

// Leaves of each triangle's samples the one that is farthest off, if it is farther than `least`. Returns the
// end of what is left. f(distance) of all.
template <class F>
Samples::iterator thin(const RefineMesh& mesh, Samples::iterator begin, Samples::iterator end,
                       double least, F&& f) {
  auto left = begin;
  for (auto s = begin; s != end;) {
    const std::uint32_t triangle = s->triangle;
    const MeasuredTriangle shape(mesh.shape(triangle));
    SurfaceSample farthest = *s;
    double most = -1;
    for (; s != end && s->triangle == triangle; ++s) {
      const double distance = std::sqrt(shape.squared_distance(s->point));
      f(distance);
      if (distance < most || (distance == most && s->point > farthest.point)) continue;
      most = distance;
      farthest = *s;
    }
    if (most > least) *left++ = farthest;
  }
  return left;
}

}  // namespace

void thin_samples(RefineMesh& mesh, double tolerance) {
  const auto end =
      thin(mesh, mesh.samples.begin(), mesh.samples.end(), tolerance / 8, [](double) {});
  mesh.samples.erase(end, mesh.samples.end());
}

void keep_farthest_samples(RefineMesh& mesh, RefineCounts& counts) {
  constexpr std::size_t at_once = std::size_t{1} << 15;
  struct Part {
    Samples::iterator begin, end;
    RefineCounts counts = {};
  };
  std::vector<Part> parts;
  Samples& samples = mesh.samples;
  for (auto begin = samples.begin(); begin != samples.end();) {
    auto end = begin + std::min<std::ptrdiff_t>(at_once, samples.end() - begin);
    while (end != samples.end() && end->triangle == (end - 1)->triangle) ++end;
    parts.push_back({begin, end});
    begin = end;
  }
  for_each_index(parts.size(), [&](std::size_t i) {
    Part& part = parts[i];
    part.end = thin(mesh, part.begin, part.end, -1,
                    [&](double distance) { part.counts.add_distance(distance); });
  });
  auto left = samples.begin();
  for (const Part& part : parts) {
    counts.add(part.counts);
    left = left == part.begin ? part.end : std::move(part.begin, part.end, left);
  }
  samples.erase(left, samples.end());
}

}  // namespace voxweld
