// Which edges come an odd number of times, in bounded memory, however many there are.
//
// Edges are gathered, sorted, and cancelled in pairs; what is left when most of the memory is taken
// goes to a scratch file as a run, and in the end all runs are merged. Of a closed mesh whose
// triangles come in a coherent order hardly any edge gets there.
#pragma once

#include <filesystem>
#include <functional>

#include "storage/support/external_sorter.h"
#include "storage/types/box.h"

namespace voxweld {

// By x, then y, then z.
inline bool place_before(Vec3 a, Vec3 b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

struct PlaceEdge {
  Vec3 low, high;  // its ends; place_before(low, high)
};

class EdgeParity {
 public:
  // folder: for the scratch file, which is made when needed. memory: bytes taken at most.
  EdgeParity(std::filesystem::path folder, std::uint64_t memory)
      : sorter_(std::move(folder), memory / 9 * 8) {}

  // Zeros of either sign are the same.
  void add(Vec3 a, Vec3 b);
  // Calls f with each edge that was added an odd number of times, ascending; then it is empty.
  void finish(const std::function<void(const PlaceEdge&)>& f);

 private:
  struct Order {
    using Head = PlaceEdge;
    static bool less(const PlaceEdge& a, const PlaceEdge& b);
    static bool join(PlaceEdge&, const PlaceEdge&) { return false; }
  };

  ExternalSorter<Order> sorter_;
};

}  // namespace voxweld
