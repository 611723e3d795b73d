#include <algorithm>

#include "stages/filter/grid_kernel.h"

namespace voxweld {
namespace {

using namespace filter_detail;

// Axis a of the result is axis order[a] of the input, turned around where turned[a].
struct Orientation {
  std::array<int, 3> order{0, 1, 2};
  std::array<bool, 3> turned{};
};

Index3 size_of(const SampleGrid& input, const Orientation& o) {
  return {input.size[o.order[0]], input.size[o.order[1]], input.size[o.order[2]]};
}

// A walk through the samples: from where, how far a step along each axis of the result goes.
struct Walk {
  std::int64_t start = 0;
  Index3 step;
};

// Rows along x where those of the input are read along another axis: squares of both axes, whose
// lines stay in the nearest cache.
template <class T>
void copy_box(const T* from, const Walk& walk, Index3 size, int across, T* to) {
  constexpr std::int64_t square = 32;
  const int other = 3 - across;
  const Index3 step{1, size.x, size.x * size.y};
  for (std::int64_t o = 0; o < size[other]; ++o)
    for (std::int64_t a = 0; a < size[across]; a += square)
      for (std::int64_t x = 0; x < size.x; x += square)
        for (std::int64_t i = a; i < std::min(a + square, size[across]); ++i) {
          const T* source = from + o * walk.step[other] + i * walk.step[across];
          T* target = to + o * step[other] + i * step[across];
          for (std::int64_t j = x; j < std::min(x + square, size.x); ++j)
            target[j] = source[j * walk.step.x];
        }
}

template <class T>
void copy_rows(const T* from, const Walk& walk, Index3 size, T* to) {
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y, to += size.x) {
      const T* source = from + z * walk.step.z + y * walk.step.y;
      if (walk.step.x == 1)
        std::copy_n(source, size.x, to);
      else
        std::reverse_copy(source - size.x + 1, source + 1, to);
    }
}

class OrientationKernel final : public GridKernel {
 public:
  OrientationKernel(const SampleGrid& input, const Orientation& orientation)
      : GridKernel(input, {size_of(input, orientation), input.type}), orientation_(orientation) {}

  Box3 needs(const Box3& box) const override {
    Box3 in;
    for (int axis = 0; axis < 3; ++axis) {
      const int source = orientation_.order[static_cast<std::size_t>(axis)];
      const bool turned = orientation_.turned[static_cast<std::size_t>(axis)];
      in.lo[source] = turned ? input().size[source] - box.hi[axis] : box.lo[axis];
      in.hi[source] = turned ? input().size[source] - box.lo[axis] : box.hi[axis];
    }
    return in;
  }
  bool one_to_one() const override { return true; }
  std::uint64_t scratch_bytes(const Box3&) const override { return 0; }

  void apply(const Box3& box, std::span<const std::byte> samples,
             std::span<std::byte> out) const override {
    dispatch_sample_type(input().type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      const Walk walk = walk_of(box);
      const T* from = samples_as<T>(samples) + walk.start;
      if (orientation_.order[0] == 0)
        copy_rows(from, walk, box.size(), samples_as<T>(out));
      else
        copy_box(from, walk, box.size(), orientation_.order[1] == 0 ? 1 : 2, samples_as<T>(out));
    });
  }

 private:
  Walk walk_of(const Box3& box) const {
    const Index3 n = needs(box).size(), stride{1, n.x, n.x * n.y};
    Walk walk;
    for (int axis = 0; axis < 3; ++axis) {
      const int source = orientation_.order[static_cast<std::size_t>(axis)];
      const bool turned = orientation_.turned[static_cast<std::size_t>(axis)];
      walk.step[axis] = turned ? -stride[source] : stride[source];
      if (turned) walk.start += (n[source] - 1) * stride[source];
    }
    return walk;
  }

  Orientation orientation_;
};

}  // namespace

std::unique_ptr<FilterKernel> flip_kernel(const SampleGrid& input, std::array<bool, 3> axes) {
  return std::make_unique<OrientationKernel>(input, Orientation{.turned = axes});
}

std::unique_ptr<FilterKernel> permute_kernel(const SampleGrid& input, std::array<int, 3> order) {
  return std::make_unique<OrientationKernel>(input, Orientation{.order = order});
}

}  // namespace voxweld
