#include "pipeline/phantom/fields.h"

#include <fmt/format.h>

#include "pipeline/phantom/csg_field.h"
#include "pipeline/phantom/junctions_field.h"
#include "pipeline/phantom/lattice_fields.h"
#include "pipeline/phantom/porous_field.h"
#include "pipeline/phantom/smooth_fields.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::int64_t largest_size = (std::int64_t{1} << 19) - 2;  // what the octree can hold

void check_size(PhantomKind kind, std::int64_t size) {
  if (size < 1 || size > largest_size)
    throw InputError(
        fmt::format("phantom {}: size {} is out of range: expected 1 to {} samples a side",
                    phantom_kind_name(kind), size, largest_size));
}

}  // namespace

std::unique_ptr<const AnalyticField> make_analytic_field(PhantomKind kind, std::int64_t size) {
  check_size(kind, size);
  switch (kind) {
    case PhantomKind::sphere:
      return std::make_unique<SphereField>(Ball(size));
    case PhantomKind::torus:
      return std::make_unique<TorusField>(Ring(size));
    case PhantomKind::gyroid:
      return std::make_unique<GyroidField>(size);
    case PhantomKind::part:
      return std::make_unique<CsgField>(part_model(), size);
    case PhantomKind::temple:
      return std::make_unique<CsgField>(temple_model(), size);
    default:
      throw InputError(fmt::format(
          "phantom {} has no surface known in closed form: expected sphere, torus, gyroid, "
          "part or temple",
          phantom_kind_name(kind)));
  }
}

std::unique_ptr<const PhantomField> make_phantom_field(PhantomKind kind, std::int64_t size,
                                                       std::uint64_t seed) {
  check_size(kind, size);
  switch (kind) {
    case PhantomKind::labels:
      return std::make_unique<LabelsField>(size, seed);
    case PhantomKind::junctions:
      return std::make_unique<JunctionsField>(size);
    case PhantomKind::porous:
      return std::make_unique<PorousField>(size, seed);
    case PhantomKind::noise:
      return std::make_unique<NoiseField>(seed);
    default:
      return make_analytic_field(kind, size);
  }
}

}  // namespace voxweld
