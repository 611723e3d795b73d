// The true surface of a solid made of primitives, and the distance to it.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/phantom/csg_model.h"

namespace voxweld {

class CsgSurface {
 public:
  explicit CsgSurface(CsgModel model);

  const CsgModel& model() const { return model_; }
  // The running minimum and maximum of the primitives at q.
  double value(Vec3 q) const;

  // The distance from q to the boundary of the solid, in model units. The boundary is made of
  // pieces of planes and cylinder walls, so the nearest point of it is the nearest point of one of
  // them, of the curve where two meet, or a point where three meet: each such candidate near q is
  // found (closed form or Newton's method), kept if it lies on the boundary, and the nearest kept
  // one is the answer. A candidate as near as |value(q)|, which is a lower bound, ends the search.
  double distance(Vec3 q) const;

 private:
  // A plane (normal, through point) or the wall of a cylinder along `axis` through point.
  struct Sheet {
    int axis = -1;  // of a cylinder; -1: a plane
    Vec3 point, normal;
    double radius = 0;
    std::size_t primitive = 0;
  };
  struct Tangent {  // a sheet's signed distance and its gradient at a point
    double value;
    Vec3 normal;
  };
  struct Near {
    const Sheet* sheet;
    double distance;
  };
  struct Best {
    Vec3 from;
    double distance, lower_bound;
  };

  struct Winner {  // the value and the primitive it comes from
    double value;
    std::size_t primitive;
  };

  static std::vector<Sheet> sheets_of(const CsgModel& model);
  Winner winner(Vec3 q) const;
  static Tangent tangent(const Sheet& sheet, Vec3 q);
  // The point of all the sheets' intersection nearest to `from`, found near it; false if none.
  static bool meet(const Sheet* const* sheets, int count, Vec3 from, Vec3& found);
  std::vector<Near> near(Vec3 q, double radius) const;
  void consider(const Sheet* const* sheets, int count, Best& best) const;
  void search(const std::vector<Near>& candidates, Best& best) const;

  CsgModel model_;
  std::vector<Sheet> sheets_;
};

}  // namespace voxweld
