#include "stages/exact/intersections.h"

namespace voxweld {

std::vector<LatticeBox> boxes_of(const TriangleList& mesh) {
  std::vector<LatticeBox> boxes;
  boxes.reserve(mesh.size());
  for (std::size_t i = 0; i < mesh.size(); ++i) boxes.push_back(LatticeBox::around(mesh[i]));
  return boxes;
}

void each_intersection(const TriangleList& mesh, const PairVisitor& f) {
  const std::vector<LatticeBox> boxes = boxes_of(mesh);
  const BoxTree tree(boxes);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    const LatticeTriangle own = mesh[i];
    tree.each_meeting(boxes[i], [&](std::uint32_t j) {
      if (j > i && intersect_beyond_shared(own, mesh[j])) f(i, j);
    });
  }
}

void each_intersection(const TriangleList& mesh, const OtherTriangles& others,
                       const PairVisitor& f) {
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    const LatticeTriangle own = mesh[i];
    others.tree.each_meeting(LatticeBox::around(own), [&](std::uint32_t j) {
      if (intersect_beyond_shared(own, others.triangles[j])) f(i, j);
    });
  }
}

}  // namespace voxweld
