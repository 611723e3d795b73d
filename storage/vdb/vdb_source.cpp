#include "storage/vdb/vdb_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "storage/support/error.h"
#include "storage/vdb/vdb_choice.h"
#include "storage/vdb/vdb_file.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

// Axes that are perpendicular but for the digits of a transform.
constexpr double most_skew = 1e-3;
constexpr std::int64_t vdb_leaf = 8;

void read_transform(const VdbGrid& grid, const Box3& box, const std::string& where,
                    VolumeInfo& info) {
  if (!grid.linear)
    throw FormatError(fmt::format(
        "{}: its transform is a {}, in which voxels differ in size and shape: expected a linear "
        "one: resample the grid",
        where, grid.map));
  std::array<Vec3, 3> steps;
  Vec3 origin;
  for (int column = 0; column < 3; ++column) {
    origin[column] = grid.matrix[3][column];
    for (int axis = 0; axis < 3; ++axis) {
      steps[static_cast<std::size_t>(axis)][column] = grid.matrix[axis][column];
      origin[column] += static_cast<double>(box.lo[axis]) * grid.matrix[axis][column];
    }
  }
  set_axes(info, steps, where + ": its transform");
  const auto& d = info.geometry.direction;
  const double skew =
      std::max({std::abs(dot(d[0], d[1])), std::abs(dot(d[1], d[2])), std::abs(dot(d[2], d[0]))});
  if (skew > most_skew)
    throw FormatError(fmt::format(
        "{}: its transform is sheared: the cosine of two axes is {:.4f}, and a level set's values "
        "are distances in the world: expected perpendicular axes: resample the grid",
        where, skew));
  info.geometry.origin = origin;
}

// One sample more than the active voxels on each side: what lies there is of no surface any more.
Box3 box_around(const VdbFile::OpenGrid& opened, const VdbGrid& grid, const std::string& where) {
  if (opened.active.empty())
    throw InputError(where + ": it has no active voxel, so there is nothing to read");
  const Box3 box{opened.active.lo - splat(1), opened.active.hi + splat(1)};
  constexpr double most_samples = 0x1p59;
  const Index3 size = box.size();
  if (static_cast<double>(size.x) * static_cast<double>(size.y) * static_cast<double>(size.z) >
      most_samples)
    throw FormatError(fmt::format(
        "{}: its active voxels reach from ({}, {}, {}) to ({}, {}, {}), {} x {} x {} samples, more "
        "than 2^59: a stray voxel or tile is active far off, or the file is damaged: clip the grid",
        where, box.lo.x + 1, box.lo.y + 1, box.lo.z + 1, box.hi.x - 2, box.hi.y - 2, box.hi.z - 2,
        size.x, size.y, size.z));
  checked_volume_bytes(size, static_cast<SampleType>(grid.sample), where);
  return box;
}

class VdbSource final : public SampleSource {
 public:
  explicit VdbSource(const InputSpec& spec) : file_(spec.path) {
    const std::size_t chosen = chosen_grid(file_.grids(), spec, info_);
    const VdbGrid grid = file_.grids()[chosen];
    const std::string where = fmt::format("{}: grid '{}'", spec.path, grid.name);
    const VdbFile::OpenGrid opened = file_.open(chosen);
    const Box3 box = box_around(opened, grid, where);
    first_ = box.lo;
    info_.format = "vdb";
    info_.type = static_cast<SampleType>(grid.sample);
    info_.geometry.size = box.size();
    read_transform(grid, box, where, info_);
    info_.files.push_back({spec.path, file_.state()});
    info_.access = Access::box;
    info_.chunk = splat(vdb_leaf);
    for (int a = 0; a < 3; ++a) info_.chunk_first[a] = -first_[a] & (vdb_leaf - 1);
    // The samples of a box, and the leaves that it reaches into.
    info_.largest_decode = opened.bytes + 5 * vdb_piece_samples * sample_bytes(info_.type) / 2;
    if (std::strcmp(grid.grid_class, "level set") == 0)
      info_.surface = KnownSurface{.isovalue = 0, .inside_below = true};
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    const std::size_t width = sample_bytes(info_.type);
    const Index3 size = box.size();
    if (std::max({size.x, size.y, size.z}) <= vdb_piece)
      return file_.read({box.lo + first_, box.hi + first_}, width, out);
    std::vector<std::byte> samples;
    for (std::int64_t z = box.lo.z; z < box.hi.z; z += vdb_piece)
      for (std::int64_t y = box.lo.y; y < box.hi.y; y += vdb_piece)
        for (std::int64_t x = box.lo.x; x < box.hi.x; x += vdb_piece) {
          const Index3 lo{x, y, z};
          const Box3 piece = intersect(box, {lo, lo + splat(vdb_piece)});
          samples.resize(static_cast<std::size_t>(piece.count()) * width);
          file_.read({piece.lo + first_, piece.hi + first_}, width, samples.data());
          copy_piece(piece, samples.data(), box, out);
        }
  }

 private:
  void copy_piece(const Box3& piece, const std::byte* samples, const Box3& box,
                  std::byte* out) const {
    const std::size_t width = sample_bytes(info_.type);
    const std::size_t row = static_cast<std::size_t>(piece.size().x) * width;
    const Index3 size = box.size();
    for (std::int64_t z = piece.lo.z; z < piece.hi.z; ++z)
      for (std::int64_t y = piece.lo.y; y < piece.hi.y; ++y, samples += row) {
        const Index3 to = Index3{piece.lo.x, y, z} - box.lo;
        std::memcpy(out + static_cast<std::size_t>((to.z * size.y + to.y) * size.x + to.x) * width,
                    samples, row);
      }
  }

  VdbFile file_;
  VolumeInfo info_;
  Index3 first_;  // the grid's index of sample (0, 0, 0)
};

}  // namespace

std::unique_ptr<SampleSource> open_vdb(const InputSpec& spec) {
  return std::make_unique<VdbSource>(spec);
}

}  // namespace voxweld
