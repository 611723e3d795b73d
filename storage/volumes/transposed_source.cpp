#include "storage/volumes/transposed_source.h"

#include <cstring>
#include <utility>
#include <vector>

#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

// What is read at once, in the source's axes: 1 MiB of the widest samples, in long rows.
constexpr Index3 transpose_tile{256, 32, 16};

class TransposedSource final : public SampleSource {
 public:
  TransposedSource(std::shared_ptr<SampleSource> source, const std::array<int, 3>& along,
                   VolumeInfo info)
      : source_(std::move(source)), along_(along), info_(std::move(info)) {
    info_.access = Access::box;
    info_.row_major = false;
    info_.largest_decode =
        source_->info().largest_decode +
        static_cast<std::uint64_t>(transpose_tile.x * transpose_tile.y * transpose_tile.z) *
            sample_bytes(info_.type);
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    Box3 inner;
    for (int axis = 0; axis < 3; ++axis) {
      inner.lo[axis] = box.lo[along(axis)];
      inner.hi[axis] = box.hi[along(axis)];
    }
    std::vector<std::byte> samples;
    for (Index3 at = inner.lo; at.z < inner.hi.z; at.z += transpose_tile.z)
      for (at.y = inner.lo.y; at.y < inner.hi.y; at.y += transpose_tile.y)
        for (at.x = inner.lo.x; at.x < inner.hi.x; at.x += transpose_tile.x) {
          const Box3 part{at, min(at + transpose_tile, inner.hi)};
          samples.resize(static_cast<std::size_t>(part.count()) * sample_bytes(info_.type));
          source_->read(part, samples.data());
          dispatch_sample_type(info_.type, [&](auto tag) {
            scatter<typename decltype(tag)::type>(part, samples.data(), {box, out});
          });
        }
  }

 private:
  struct Target {
    Box3 box;
    std::byte* out;
  };

  int along(int axis) const { return along_[static_cast<std::size_t>(axis)]; }

  template <class T>
  void scatter(const Box3& part, const std::byte* samples, const Target& target) const {
    const Index3 size = target.box.size();
    const Index3 step{1, size.x, size.x * size.y};
    Index3 place;  // of a sample of the source in the target, along each axis of the source
    for (int axis = 0; axis < 3; ++axis) place[axis] = step[along(axis)];
    for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
      for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
        const Index3 first{part.lo.x, y, z};
        std::int64_t to = 0;
        for (int axis = 0; axis < 3; ++axis)
          to += (first[axis] - target.box.lo[along(axis)]) * place[axis];
        for (std::int64_t x = part.lo.x; x < part.hi.x; ++x, to += place.x, samples += sizeof(T))
          std::memcpy(target.out + static_cast<std::size_t>(to) * sizeof(T), samples, sizeof(T));
      }
  }

  std::shared_ptr<SampleSource> source_;
  std::array<int, 3> along_;
  VolumeInfo info_;
};

}  // namespace

std::unique_ptr<SampleSource> transposed_source(std::shared_ptr<SampleSource> source,
                                                const std::array<int, 3>& along, VolumeInfo info) {
  return std::make_unique<TransposedSource>(std::move(source), along, std::move(info));
}

}  // namespace voxweld
