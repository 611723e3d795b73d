#include "stages/encode/lattice_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/support/error.h"

namespace voxweld {
namespace {

std::size_t lowest_corner(const std::array<LatticePoint, 3>& p) {
  return static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
}

}  // namespace

LatticePoint lattice_point(const std::array<float, 3>& p, const OutputLattice& lattice,
                           const std::string& where) {
  LatticePoint q;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Exact: the step is a power of two, and both terms are small multiples of it.
    const double value = (static_cast<double>(p[axis]) - lattice.origin[axis]) / lattice.step;
    if (!(value >= 0 && value < static_cast<double>(std::int64_t{1} << lattice.bits)) ||
        value != std::floor(value))
      throw FormatError(fmt::format(
          "{}: coordinate {} on axis {} is no point of the output lattice (origin {}, step {}, {} "
          "bits): the file was not encoded on it",
          where, p[axis], axis, lattice.origin[axis], lattice.step, lattice.bits));
    q[axis] = static_cast<std::int32_t>(value);
  }
  return q;
}

std::uint32_t PointIndex::add(const LatticePoint& q) {
  const std::uint64_t hash = hash_point(q);
  const std::uint32_t found = table_.find(hash, [&](std::uint32_t i) { return points_[i] == q; });
  if (found != none) return found;
  if (points_.size() >= none)
    throw InputError("a mesh of more than 4,294,967,294 vertices cannot be held in one piece");
  const auto index = static_cast<std::uint32_t>(points_.size());
  points_.push_back(q);
  table_.insert(hash, index);
  return index;
}

std::uint32_t PointIndex::find(const LatticePoint& q) const {
  return table_.find(hash_point(q), [&](std::uint32_t i) { return points_[i] == q; });
}

void PointIndex::reserve(std::size_t count) {
  points_.reserve(count);
  table_.reserve(count);
}

LatticeMesh weld(const DecodedMesh& mesh, const OutputLattice& lattice, const std::string& where) {
  PointIndex index;
  index.reserve(mesh.positions.size());
  std::vector<std::uint32_t> welded(mesh.positions.size(), PointIndex::none);
  LatticeMesh out;
  out.triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    Triangle& corner = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& w = welded[t[k]];
      if (w == PointIndex::none) w = index.add(lattice_point(mesh.positions[t[k]], lattice, where));
      corner[k] = w;
    }
  }
  out.positions = index.take();
  out.pairs.reserve(mesh.triangle_pairs.size());
  for (const std::uint32_t pair : mesh.triangle_pairs) out.pairs.push_back(mesh.pairs[pair]);
  return out;
}

TriangleDigest digest(const std::array<LatticePoint, 3>& p, const MaterialPair* pair) {
  const std::size_t first = lowest_corner(p);
  std::uint64_t a = 0x9e3779b97f4a7c15ULL, b = 0x2545f4914f6cdd1dULL;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint64_t h = hash_point(p[(first + k) % 3]);
    a = mix_bits(a + h);
    b = mix_bits((b ^ h) * 0x9fb21c651e98df25ULL);
  }
  if (pair != nullptr) {
    a = mix_bits(a + mix_bits(pair->inside) * 3);
    b = mix_bits(b ^ mix_bits(pair->outside + 1));
  }
  return {1, a, b};
}

TriangleDigest digest(const LatticeMesh& mesh) {
  TriangleDigest sum;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    sum += digest({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]},
                  mesh.pairs.empty() ? nullptr : &mesh.pairs[i]);
  }
  return sum;
}

}  // namespace voxweld
