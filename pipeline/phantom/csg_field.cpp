#include "pipeline/phantom/csg_field.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace voxweld {
namespace {

using Op = CsgPrimitive::Op;

// Which primitives can matter within a ball, and bounds of the whole there. Exact: with a
// primitive's distance known at the centre, it lies within +-radius of that in the ball, so a union
// with something larger throughout, or a subtraction of something farther throughout, changes no
// value, and one that wins throughout makes all before it irrelevant.
struct Program {
  std::vector<const CsgPrimitive*> steps;
  double lo = std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
};

void plan(const CsgModel& model, Vec3 centre, double radius, Program& program) {
  program.steps.clear();
  double lo = std::numeric_limits<double>::infinity(), hi = lo;
  for (const CsgPrimitive& primitive : model.primitives) {
    const double d = signed_distance(primitive, centre);
    if (primitive.op == Op::unite) {
      if (d - radius >= hi) continue;
      if (d + radius <= lo) program.steps.clear();
      lo = std::min(lo, d - radius);
      hi = std::min(hi, d + radius);
    } else {
      if (-d + radius <= lo) continue;
      if (-d - radius >= hi) program.steps.clear();
      lo = std::max(lo, -d - radius);
      hi = std::max(hi, -d + radius);
    }
    program.steps.push_back(&primitive);
  }
  program.lo = lo;
  program.hi = hi;
}

// Model coordinates of one row's samples and the running value there.
struct Row {
  std::vector<double> x, y, z, distance;

  void resize(std::size_t count) {
    for (auto* v : {&x, &y, &z, &distance}) v->resize(count);
  }
};

void run(const Program& program, Row& row, std::size_t count, double* out) {
  bool first = true;
  for (const CsgPrimitive* step : program.steps) {
    double* const d = row.distance.data();
    signed_distances(*step, row.x.data(), row.y.data(), row.z.data(), count, d);
    const bool unite = step->op == Op::unite;
    if (first)
      for (std::size_t i = 0; i < count; ++i) out[i] = unite ? d[i] : -d[i];
    else if (unite)
      for (std::size_t i = 0; i < count; ++i) out[i] = std::min(out[i], d[i]);
    else
      for (std::size_t i = 0; i < count; ++i) out[i] = std::max(out[i], -d[i]);
    first = false;
  }
}

}  // namespace

CsgField::CsgField(const CsgModel& model, std::int64_t size)
    : surface_(model),
      centre_((static_cast<double>(size) - 1) / 2),
      scale_(static_cast<double>(size) / 512) {}

Vec3 CsgField::to_model(Vec3 p) const {
  const Vec3 r = p - Vec3{centre_, centre_, centre_};
  return apply(surface_.model().rows, {r.x / scale_, r.y / scale_, r.z / scale_});
}

double CsgField::at(Vec3 p) const {
  return scale_ * surface_.value(to_model(p));
}
double CsgField::surface_distance(Vec3 p) const {
  return scale_ * surface_.distance(to_model(p));
}

void CsgField::fill(const Box3& box, double limit, double* out) const {
  const Index3 size = box.size();
  const auto half = [](std::int64_t lo, std::int64_t n) {
    return static_cast<double>(lo) + static_cast<double>(n - 1) / 2;
  };
  const Vec3 middle{half(box.lo.x, size.x), half(box.lo.y, size.y), half(box.lo.z, size.z)};
  const Vec3 reach = middle - Vec3{static_cast<double>(box.lo.x), static_cast<double>(box.lo.y),
                                   static_cast<double>(box.lo.z)};
  // The margin covers rounding, so that leaving a primitive out never changes a bit.
  const double radius = std::sqrt(dot(reach, reach)) / scale_ * (1 + 1e-9) + 1e-6;
  Program program;
  plan(surface_.model(), to_model(middle), radius, program);
  if (program.lo * scale_ > limit || program.hi * scale_ < -limit) {
    std::fill_n(out, box.count(), program.lo > 0 ? program.lo * scale_ : program.hi * scale_);
    return;
  }
  Row row;
  const auto count = static_cast<std::size_t>(size.x);
  row.resize(count);
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z) {
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, out += count) {
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 q = to_model({static_cast<double>(box.lo.x + static_cast<std::int64_t>(i)),
                                 static_cast<double>(y), static_cast<double>(z)});
        row.x[i] = q.x;
        row.y[i] = q.y;
        row.z[i] = q.z;
      }
      run(program, row, count, out);
      for (std::size_t i = 0; i < count; ++i) out[i] *= scale_;
    }
  }
}

}  // namespace voxweld
