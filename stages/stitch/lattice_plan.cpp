#include "stages/stitch/lattice_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"

namespace voxweld {
namespace {

double power_of_two_at_most(double v) {
  int exponent = 0;
  std::frexp(v, &exponent);
  return std::ldexp(1.0, exponent - 1);
}

// With room for vertices that are snapped beyond the end.
int bits_for(double extent, double step) {
  int bits = 1;
  while (std::ldexp(1.0, bits) < extent / step + 1 + most_snap_steps) ++bits;
  return bits;
}

}  // namespace

OutputLattice plan_lattice(const LatticeRequest& request) {
  const Vec3& s = request.spacing;
  const double smallest = std::min({s.x, s.y, s.z});
  OutputLattice lattice;
  lattice.step = power_of_two_at_most(std::min(request.precision, smallest / 4));
  double extent = 0;
  for (int a = 0; a < 3; ++a) {
    // The first lattice point at or below the ring.
    const auto first = static_cast<double>(request.first[a]);
    const double origin = std::floor((first - 1) * s[a] / lattice.step) * lattice.step;
    lattice.origin[static_cast<std::size_t>(a)] = origin;
    extent =
        std::max(extent, static_cast<double>(request.first[a] + request.size[a]) * s[a] - origin);
  }
  lattice.bits = bits_for(extent, lattice.step);
  if (lattice.bits > max_lattice_bits) {
    double step = lattice.step;
    while (bits_for(extent, step) > max_lattice_bits) step *= 2;
    throw InputError(fmt::format(
        "output.precision: a lattice of step {} over {} needs {} bits a coordinate; {} decode "
        "exactly. "
        "Use output.precision = {:.6g} (voxels) or more{}",
        lattice.step, extent, lattice.bits, max_lattice_bits, step / smallest,
        step > smallest / 4 ? ", or crop the volume: this step would be over a quarter of a voxel"
                            : ""));
  }
  return lattice;
}

}  // namespace voxweld
