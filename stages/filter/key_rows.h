// The rows of keys around a row of a result, drawn out along x by a radius: beyond the volume the
// nearest sample goes on. Only the slices that one slice of the result needs are kept.
#pragma once

#include <algorithm>

#include "stages/filter/grid_kernel.h"
#include "stages/filter/sample_keys.h"

namespace voxweld::filter_detail {

struct KeyRowsShape {
  Box3 box, in;  // of the result, and what it needs
  Index3 radius;

  std::int64_t pitch() const { return box.size().x + 2 * radius.x; }
  std::int64_t slices() const { return std::min(2 * radius.z + 1, in.size().z); }
  std::int64_t keys() const { return pitch() * in.size().y * slices(); }
};

template <class T>
class KeyRows {
 public:
  // samples: those of shape.in.
  KeyRows(const KeyRowsShape& shape, const T* samples)
      : shape_(shape), samples_(samples), keys_(buffer_of<Key<T>>(shape.keys())) {}

  // Makes all rows ready that a slice of the result needs. Slices are asked for in turn.
  void go_to(std::int64_t z) {
    const std::int64_t end = std::min(z + shape_.radius.z + 1, shape_.in.hi.z);
    for (next_ = std::max(next_, shape_.in.lo.z); next_ < end; ++next_)
      for (std::int64_t y = shape_.in.lo.y; y < shape_.in.hi.y; ++y) fill_row(y, next_);
  }

  // Of the volume's row y, z or the nearest there is; the first key is that of the box's least x
  // less the radius.
  const Key<T>* row(std::int64_t y, std::int64_t z) const { return keys_.get() + place(y, z); }

 private:
  std::int64_t place(std::int64_t y, std::int64_t z) const {
    y = std::clamp(y, shape_.in.lo.y, shape_.in.hi.y - 1);
    z = std::clamp(z, shape_.in.lo.z, shape_.in.hi.z - 1);
    return (z % shape_.slices() * shape_.in.size().y + y - shape_.in.lo.y) * shape_.pitch();
  }

  void fill_row(std::int64_t y, std::int64_t z) {
    const Box3& in = shape_.in;
    const std::int64_t width = in.size().x;
    const T* from = samples_ + ((z - in.lo.z) * in.size().y + y - in.lo.y) * width;
    Key<T>* to = keys_.get() + place(y, z);
    const std::int64_t before = in.lo.x - (shape_.box.lo.x - shape_.radius.x);
    Key<T>* __restrict middle = to + before;
    for (std::int64_t x = 0; x < width; ++x) middle[x] = key_of(from[x]);
    std::fill_n(to, before, middle[0]);
    std::fill(middle + width, to + shape_.pitch(), middle[width - 1]);
  }

  KeyRowsShape shape_;
  const T* samples_;
  std::unique_ptr<Key<T>[]> keys_;
  std::int64_t next_ = 0;  // slice; those below are there or no longer needed
};

}  // namespace voxweld::filter_detail
