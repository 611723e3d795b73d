#include "stages/build/sign_grid.h"

#include <algorithm>
#include <cmath>

#include "stages/build/label_field.h"
#include "stages/contouring/inside_test.h"
#include "stages/solids/lattice_solid.h"
#include "stages/solids/solid.h"

namespace voxweld {
namespace {

// Flags of samples as vectorised comparisons leave them.
constexpr std::uint8_t set = 0xff;

// A bit for each of 64 flags.
std::uint64_t pack_flags(const std::uint8_t* flags) {
  std::uint64_t bits = 0;
#ifdef __SSE2__
  using Sixteen = char __attribute__((vector_size(16)));
  for (int group = 0; group < 4; ++group) {
    Sixteen some;
    std::memcpy(&some, flags + std::ptrdiff_t{16} * group, sizeof some);
    const auto packed = static_cast<std::uint32_t>(__builtin_ia32_pmovmskb128(some));
    bits |= std::uint64_t{packed} << (16 * group);
  }
#else
  for (int group = 0; group < 8; ++group) {
    std::uint64_t eight;
    std::memcpy(&eight, flags + std::ptrdiff_t{8} * group, sizeof eight);
    eight &= 0x0101010101010101ULL;
    bits |= (eight * 0x0102040810204080ULL >> 56) << (8 * group);
  }
#endif
  return bits;
}

// Bit i: inside(p[i]), of 64 samples.
template <class T>
std::uint64_t pack64(const T* p, const InsideTest<T>& inside) {
  alignas(64) std::uint8_t flags[64];
  const T threshold = inside.threshold;
  if (inside.above)
    for (int i = 0; i < 64; ++i) flags[i] = p[i] >= threshold ? set : 0;
  else
    for (int i = 0; i < 64; ++i) flags[i] = p[i] <= threshold ? set : 0;
  return pack_flags(flags);
}

template <class T>
std::uint64_t pack64(const T* p, const LabelTest<T>& is_label) {
  alignas(64) std::uint8_t flags[64];
  const T value = is_label.value;
  for (int i = 0; i < 64; ++i) flags[i] = p[i] == value ? set : 0;
  return pack_flags(flags);
}

template <class T, class Inside>
std::uint64_t pack_some(const T* p, int count, const Inside& inside) {
  std::uint64_t bits = 0;
  for (int i = 0; i < count; ++i) bits |= static_cast<std::uint64_t>(inside(p[i])) << i;
  return bits;
}

// Ors `count` bits into a row from bit `at` on.
void or_bits(std::uint64_t* row, int at, std::uint64_t bits) {
  row[at >> 6] |= bits << (at & 63);
  if ((at & 63) != 0) row[(at >> 6) + 1] |= bits >> (64 - (at & 63));
}

template <class T, class Inside>
void pack_row(const T* p, int count, int at, const Inside& inside, std::uint64_t* row) {
  int done = 0;
  for (; done + 64 <= count; done += 64) or_bits(row, at + done, pack64(p + done, inside));
  if (done < count) or_bits(row, at + done, pack_some(p + done, count - done, inside));
}

// Rows of a brick lie apart in the samples, where processors do not foresee them.
constexpr std::int64_t rows_ahead = 4;

void fetch_ahead(const std::byte* begin, const std::byte* end) {
  constexpr std::ptrdiff_t line = 64;
  for (; begin < end; begin += line) __builtin_prefetch(begin);
}

// The samples whose places may lie in the solid, within `held`.
Box3 samples_near(const Solid& solid, const VolumeFrame& frame, const Box3& held) {
  const Bounds bounds = solid_bounds(solid);
  Box3 near = held;
  for (int a = 0; a < 3; ++a) {
    // One more on either side than rounding asks for.
    const double lo = bounds.lo[a] / frame.spacing[a] - 1;
    const double hi = bounds.hi[a] / frame.spacing[a] + 2;
    const auto first = static_cast<double>(held.lo[a]), end = static_cast<double>(held.hi[a]);
    near.lo[a] = static_cast<std::int64_t>(std::clamp(std::floor(lo), first, end));
    near.hi[a] = static_cast<std::int64_t>(std::clamp(std::ceil(hi), first, end));
  }
  return near;
}

// Turns the bits `from` to `end` of a row around.
void flip_bits(std::uint64_t* row, std::int64_t from, std::int64_t end) {
  const std::int64_t last = (end - 1) >> 6;
  for (std::int64_t w = from >> 6; w <= last; ++w) {
    std::uint64_t bits = ~std::uint64_t{0};
    if (w == from >> 6) bits <<= from & 63;
    if (w == last) bits &= ~std::uint64_t{0} >> (63 - ((end - 1) & 63));
    row[w] ^= bits;
  }
}

}  // namespace

void SignGrid::fill(const HaloBlock& block, Index3 brick, int side,
                    const SurfaceParameters& surface, const Box3& extent) {
  points_ = static_cast<std::size_t>(side) + 3;
  stride_ = (points_ + 63) / 64 + 1;
  bits_.assign(points_ * points_ * stride_, 0);
  // Lattice point u is sample u - 1; the grid's first point is brick - 1, so sample brick - 2.
  const Index3 first = brick - splat(2);
  const Box3 held =
      intersect(intersect(block.samples, extent), Box3{first, first + splat(side + 3)});
  if (held.empty()) return;
  dispatch_sample_type(block.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const T* data = reinterpret_cast<const T*>(block.data);
    const int count = static_cast<int>(held.size().x), at = static_cast<int>(held.lo.x - first.x);
    const auto fill_rows = [&](const auto& inside) {
      if (inside.never) return;
      for (std::int64_t z = held.lo.z; z < held.hi.z; ++z)
        for (std::int64_t y = held.lo.y; y < held.hi.y; ++y) {
          const T* p = data + (z - block.samples.lo.z) * block.slice +
                       (y - block.samples.lo.y) * block.row + (held.lo.x - block.samples.lo.x);
          if (y + rows_ahead < held.hi.y) {
            const T* ahead = p + rows_ahead * block.row;
            fetch_ahead(reinterpret_cast<const std::byte*>(ahead),
                        reinterpret_cast<const std::byte*>(ahead + count));
          }
          pack_row(p, count, at, inside, row_at(y - first.y, z - first.z));
        }
    };
    if constexpr (std::is_integral_v<T>) {
      if (surface.label) return fill_rows(LabelTest<T>(*surface.label));
    }
    fill_rows(make_inside_test<T>(surface.isovalue, surface.inside));
  });
}

bool SignGrid::is_uniform() const {
  const std::uint64_t side = (bits_.front() & 1) != 0 ? ~std::uint64_t{0} : 0;
  // Behind the last point there are zeros.
  const std::size_t whole = points_ / 64;
  const std::uint64_t rest = (std::uint64_t{1} << (points_ % 64)) - 1;
  for (const std::uint64_t* row = bits_.data(); row < bits_.data() + bits_.size(); row += stride_) {
    std::uint64_t differs = row[whole] ^ (side & rest);
    for (std::size_t w = 0; w < whole; ++w) differs |= row[w] ^ side;
    if (differs != 0) return false;
  }
  return true;
}

void SignGrid::fill(const Solid& solid, const VolumeFrame& frame, Index3 brick, int side) {
  points_ = static_cast<std::size_t>(side) + 3;
  stride_ = (points_ + 63) / 64 + 1;
  bits_.assign(points_ * points_ * stride_, 0);
  const Index3 first = brick - splat(2);
  const Box3 held = samples_near(
      solid, frame, intersect(Box3{{}, frame.size}, Box3{first, first + splat(side + 3)}));
  if (held.empty()) return;
  if (solid.shape == SolidShape::mesh)
    fill_mesh(*solid.mesh, first, held);
  else
    fill_shape(solid, frame, first, held);
}

void SignGrid::fill_shape(const Solid& solid, const VolumeFrame& frame, Index3 first,
                          const Box3& held) {
  for (std::int64_t z = held.lo.z; z < held.hi.z; ++z)
    for (std::int64_t y = held.lo.y; y < held.hi.y; ++y) {
      std::uint64_t* row = row_at(y - first.y, z - first.z);
      for (std::int64_t x = held.lo.x; x < held.hi.x; ++x) {
        const auto bit = static_cast<std::uint64_t>(x - first.x);
        if (solid_holds(solid, frame.place_of_sample({x, y, z})))
          row[bit >> 6] |= std::uint64_t{1} << (bit & 63);
      }
    }
}

void SignGrid::fill_mesh(const LatticeSolid& mesh, Index3 first, const Box3& held) {
  mesh.each_flip(held, [&](const LatticeSolid::Flip& flip) {
    flip_bits(row_at(flip.y - first.y, flip.z - first.z), flip.x - first.x, held.hi.x - first.x);
  });
}

void SignGrid::combine(EditOp op, const SignGrid& solid) {
  for (std::size_t i = 0; i < bits_.size(); ++i) {
    const std::uint64_t other = solid.bits_[i];
    bits_[i] = op == EditOp::add        ? bits_[i] | other
               : op == EditOp::subtract ? bits_[i] & ~other
                                        : bits_[i] & other;
  }
}

std::uint32_t SignGrid::signs27(int x, int y, int z, int node_side) const {
  const int half = node_side / 2;
  std::uint32_t signs = 0;
  int bit = 0;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j, bit += 3) {
      const unsigned char* bytes =
          reinterpret_cast<const unsigned char*>(row(y + j * half, z + k * half));
      std::uint32_t three = 0;
      if (half == 1) {
        std::memcpy(&three, bytes + (x + 1) / 8, sizeof three);
        three = three >> ((x + 1) & 7) & 7;
      } else {
        for (int i = 0; i < 3; ++i) {
          const int at = x + i * half + 1;
          three |= (bytes[at >> 3] >> (at & 7) & 1U) << i;
        }
      }
      signs |= three << bit;
    }
  return signs;
}

NodeCrossings SignGrid::crossings(int x, int y, int z) const {
  const std::uint32_t signs = signs27(x, y, z, 2);
  NodeCrossings crossings{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    crossings[axis] = (signs ^ signs >> bits_along[axis]) & edges_of_node[axis];
  return crossings;
}

}  // namespace voxweld
