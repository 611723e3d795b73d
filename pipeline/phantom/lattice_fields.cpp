#include "pipeline/phantom/lattice_fields.h"

#include <algorithm>
#include <limits>

#include "pipeline/phantom/rotation.h"

namespace voxweld {
namespace {

Vec3 position(std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
}

}  // namespace

void NoiseField::fill(const Box3& box, double /*limit*/, double* out) const {
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y) {
      const std::uint64_t key = row_key(seed_, y, z);
      for (std::int64_t x = box.lo.x; x < box.hi.x; ++x)
        *out++ = 16 * uniform(mix_bits(key, static_cast<std::uint64_t>(x))) - 8;
    }
}

LabelsField::LabelsField(std::int64_t size, std::uint64_t seed)
    : centre_((static_cast<double>(size) - 1) / 2), radius_(0.45 * static_cast<double>(size)) {
  constexpr std::int64_t cells = 6;
  const double side = static_cast<double>(size) / static_cast<double>(cells);
  for (std::int64_t z = 0; z < cells; ++z)
    for (std::int64_t y = 0; y < cells; ++y)
      for (std::int64_t x = 0; x < cells; ++x) {
        Vec3 p = position(x, y, z);
        const auto counter = static_cast<std::uint64_t>(x) * 3;
        for (int axis = 0; axis < 3; ++axis)
          p[axis] += 0.1 + 0.8 * uniform(mix_bits(row_key(seed, y, z),
                                                  counter + static_cast<std::uint64_t>(axis)));
        points_.push_back(p * side - Vec3{0.5, 0.5, 0.5});  // the volume spans -1/2 .. N - 1/2
      }
}

std::vector<std::size_t> LabelsField::candidates(const Box3& box) const {
  const Vec3 lo = position(box.lo.x, box.lo.y, box.lo.z);
  const Vec3 middle = (lo + position(box.hi.x - 1, box.hi.y - 1, box.hi.z - 1)) * 0.5;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points_) nearest = std::min(nearest, length(p - middle));
  const double reach = nearest + 2 * length(middle - lo) + 1e-6;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (length(points_[i] - middle) <= reach) result.push_back(i);
  return result;
}

void LabelsField::fill(const Box3& box, double /*limit*/, double* out) const {
  const std::vector<std::size_t> near = candidates(box);
  const Vec3 centre{centre_, centre_, centre_};
  fill_by_point(box, out, [&](Vec3 p) {
    double best = std::numeric_limits<double>::infinity();
    std::size_t label = 0;
    if (length(p - centre) <= radius_)
      for (const std::size_t i : near) {
        const Vec3 away = p - points_[i];
        const double d = dot(away, away);
        if (d < best) {
          best = d;
          label = i + 1;
        }
      }
    return static_cast<double>(label);
  });
}

}  // namespace voxweld
