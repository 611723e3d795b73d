#include "stages/refine/fixed_pairs.h"

#include <algorithm>

#include "stages/exact/box_tree.h"
#include "stages/exact/triangle_pair.h"

namespace voxweld {
namespace {

bool counts_here(const RefineMesh& mesh, const FixedTriangle& a, const FixedTriangle& b) {
  if (a.within != b.within) return a.within ? a.own : b.own;
  return mesh.ids_of(a.triangle) < mesh.ids_of(b.triangle) ? a.own : b.own;
}

}  // namespace

FixedPairs find_fixed_pairs(const RefineMesh& mesh, const std::vector<FixedTriangle>& fixed) {
  FixedPairs found;
  std::vector<LatticeBox> boxes;
  boxes.reserve(fixed.size());
  for (const FixedTriangle& f : fixed) boxes.push_back(mesh.box(f.triangle));
  const BoxTree tree(boxes);
  for (std::uint32_t i = 0; i < fixed.size(); ++i) {
    const FixedTriangle& a = fixed[i];
    if (mesh.checked ? !mesh.intersects(a.triangle) : !a.own) continue;
    const LatticeTriangle shape = mesh.shape(a.triangle);
    tree.each_meeting(boxes[i], [&](std::uint32_t j) {
      const FixedTriangle& b = fixed[j];
      // Where both are looked at, once.
      const bool both = mesh.checked ? mesh.intersects(b.triangle) : b.own;
      if (i == j || (both && j < i) || (!a.own && !b.own)) return;
      if (!intersect_beyond_shared(shape, mesh.shape(b.triangle))) return;
      found.pairs += counts_here(mesh, a, b) ? 1 : 0;
      if (a.own) found.intersecting.push_back(a.triangle);
      if (b.own) found.intersecting.push_back(b.triangle);
    });
  }
  std::sort(found.intersecting.begin(), found.intersecting.end());
  found.intersecting.erase(std::unique(found.intersecting.begin(), found.intersecting.end()),
                           found.intersecting.end());
  return found;
}

}  // namespace voxweld
