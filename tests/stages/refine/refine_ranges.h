// A mesh refined in one range or several, as the units of a run do it.
#pragma once

#include <algorithm>
#include <vector>

#include "stages/refine/mesh_part.h"
#include "stages/refine/refine_range.h"

namespace voxweld::testing {

inline std::vector<CubeRange> cut_at(const std::vector<std::uint64_t>& codes) {
  std::vector<CubeRange> ranges(1);
  for (const std::uint64_t code : codes) {
    ranges.back().end = code;
    ranges.push_back({code, CubeRange{}.end});
  }
  return ranges;
}

// What a unit would be given: at home there, or near enough.
inline RefineMesh needed(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own) {
  std::vector<LatticeBox> near;
  const auto at_home = [&](std::size_t t) {
    return own.contains(cubes.code(home_of(mesh, t, cubes)));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (at_home(t)) near.push_back(cubes.box(home_of(mesh, t, cubes)));
  MeshGather part;
  part.add(mesh, [&](std::size_t t) {
    return at_home(t) ||
           std::ranges::any_of(near, [&](const LatticeBox& box) { return box.meets(mesh.box(t)); });
  });
  return part.take();
}

struct Refined {
  RefineMesh mesh;
  RefineCounts counts;
};

inline Refined refine_in(const RefineMesh& mesh, const RefineFrame& frame, int pass,
                         const std::vector<CubeRange>& ranges, const RefineParameters& parameters,
                         bool all_is_given) {
  const CubeLattice cubes(frame, pass);
  MeshGather whole;
  Refined refined;
  for (const CubeRange& range : ranges)
    whole.add(refine_range(all_is_given ? mesh : needed(mesh, cubes, range), cubes, range,
                           parameters, refined.counts));
  refined.mesh = whole.take();
  return refined;
}

}  // namespace voxweld::testing
