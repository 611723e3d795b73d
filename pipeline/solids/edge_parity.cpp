#include "pipeline/solids/edge_parity.h"

namespace voxweld {
bool EdgeParity::Order::less(const PlaceEdge& a, const PlaceEdge& b) {
  return a.low != b.low ? place_before(a.low, b.low) : place_before(a.high, b.high);
}

void EdgeParity::add(Vec3 a, Vec3 b) {
  a = a + Vec3{};
  b = b + Vec3{};
  sorter_.push(place_before(a, b) ? PlaceEdge{a, b} : PlaceEdge{b, a});
}

void EdgeParity::finish(const std::function<void(const PlaceEdge&)>& f) {
  PlaceEdge edge;
  while (sorter_.next(edge)) f(edge);
  sorter_.clear();
}

}  // namespace voxweld
