#include "storage/vdb/vdb_library.h"

#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "storage/support/child_service.h"
#include "storage/types/sample_type.h"

namespace voxweld {
namespace {

// For a box of samples: seconds, and what the buffers of its leaves take.
constexpr ServiceRules rules_of_reading{.most_seconds = 10,
                                        .most_more_bytes = std::uint64_t{256} << 20};
constexpr std::int64_t leaf_side = openvdb::FloatTree::LeafNodeType::DIM;

// The grids of a file by what stands before each, which tells where it ends: OpenVDB takes what is
// cut off a file for zeros.
class GridList final : public openvdb::io::Archive {
 public:
  // The byte behind the last grid.
  std::uint64_t end(std::istream& file) {
    readHeader(file);
    setFormatVersion(file);  // which what follows depends on
    setLibraryVersion(file);
    setDataCompression(file);
    openvdb::MetaMap of_file;
    of_file.readMeta(file);
    if (!inputHasGridOffsets())
      throw std::runtime_error(
          "it was written to a pipe and has no table of its grids: read it with OpenVDB and write "
          "it to a file");
    std::int64_t last = 0;
    for (std::int32_t left = readGridCount(file); left > 0; --left) {
      openvdb::io::GridDescriptor grid;
      grid.read(file);
      const std::int64_t begin = grid.getGridPos(), end = grid.getEndPos();
      if (!file || begin < 0 || end < begin) throw std::runtime_error("its list of grids is cut");
      last = std::max(last, end);
      grid.seekToEnd(file);
    }
    return static_cast<std::uint64_t>(last);
  }
};

template <std::size_t N>
void keep(char (&to)[N], const std::string& text) {
  const std::size_t bytes = std::min(text.size(), N - 1);
  std::memcpy(to, text.data(), bytes);
  to[bytes] = '\0';
}

void keep(std::int64_t (&to)[3], const openvdb::Coord& from) {
  for (int a = 0; a < 3; ++a) to[a] = from[a];
}

// Calls f with the grid as what it is, and a sample of ours; false for other types.
template <class F>
bool with_grid(const openvdb::GridBase& grid, F&& f) {
  const auto as = [&]<class Grid, class Sample>(std::in_place_type_t<Grid>, Sample sample) {
    if (!grid.isType<Grid>()) return false;
    f(static_cast<const Grid&>(grid), sample);
    return true;
  };
  return as(std::in_place_type<openvdb::FloatGrid>, float{}) ||
         as(std::in_place_type<openvdb::DoubleGrid>, double{}) ||
         as(std::in_place_type<openvdb::Int32Grid>, std::int32_t{}) ||
         as(std::in_place_type<openvdb::Int64Grid>, std::int64_t{}) ||
         as(std::in_place_type<openvdb::BoolGrid>, std::uint8_t{}) ||
         as(std::in_place_type<openvdb::MaskGrid>, std::uint8_t{});
}

template <class T>
constexpr SampleType sample_type_of() {
  if constexpr (std::is_same_v<T, float>) return SampleType::f32;
  if constexpr (std::is_same_v<T, double>) return SampleType::f64;
  if constexpr (std::is_same_v<T, std::int32_t>) return SampleType::i32;
  if constexpr (std::is_same_v<T, std::int64_t>) return SampleType::i64;
  return SampleType::u8;
}

void describe(const std::string& name, const openvdb::GridBase& grid, VdbGrid& to) {
  keep(to.name, name);
  keep(to.type, grid.valueType());
  keep(to.grid_class, openvdb::GridBase::gridClassToString(grid.getGridClass()));
  keep(to.map, grid.transform().mapType());
  to.half = grid.saveFloatAsHalf();
  to.sample = -1;
  with_grid(grid, [&](const auto&, auto sample) {
    to.sample = static_cast<std::int32_t>(sample_type_of<decltype(sample)>());
  });
  to.linear = grid.transform().isLinear();
  if (to.linear) {
    const openvdb::Mat4R matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) to.matrix[row][column] = matrix(row, column);
  }
  const auto low = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
  const auto high = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
  to.has_box = low && high;
  if (!to.has_box) return;
  keep(to.first, openvdb::Coord(low->value()));
  keep(to.last, openvdb::Coord(high->value()));
}

// Boxes of samples out of a grid, leaf by leaf.
template <class Grid, class Sample>
class Filling {
 public:
  Filling(const Grid& grid, const Box3& box, Sample* out)
      : grid_(grid), access_(grid.getConstAccessor()), box_(box), out_(out) {}

  bool any_leaf() {
    bool any = false;
    each_cell([&](Index3 cell, const Box3&) { any = any || leaf_at(cell) != nullptr; });
    return any;
  }
  void fill() {
    each_cell([&](Index3 cell, const Box3& part) {
      const auto* leaf = leaf_at(cell);
      if (leaf == nullptr) {
        const Sample value = value_at(cell);
        each(part, [&](Index3) { return value; });
      } else {
        each(part, [&](Index3 at) {
          const Index3 n = at - cell;
          return static_cast<Sample>(leaf->getValue(
              static_cast<openvdb::Index>((n.x * leaf_side + n.y) * leaf_side + n.z)));
        });
      }
    });
  }

 private:
  static openvdb::Coord coord(Index3 at) {
    return {static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
            static_cast<std::int32_t>(at.z)};
  }
  // Grids end at the limits of their indices; the box may have a sample more.
  static bool beyond(Index3 cell) {
    constexpr std::int64_t least = std::numeric_limits<std::int32_t>::min();
    for (int a = 0; a < 3; ++a)
      if (cell[a] < least || cell[a] > std::numeric_limits<std::int32_t>::max()) return true;
    return false;
  }

  const typename Grid::TreeType::LeafNodeType* leaf_at(Index3 cell) {
    return beyond(cell) ? nullptr : access_.probeConstLeaf(coord(cell));
  }
  Sample value_at(Index3 cell) {
    return static_cast<Sample>(beyond(cell) ? grid_.background() : access_.getValue(coord(cell)));
  }

  // f(first index, part of the box) of each cube that a leaf may fill: without one it has one value.
  template <class F>
  void each_cell(F&& f) const {
    Index3 lo;
    for (int a = 0; a < 3; ++a) lo[a] = box_.lo[a] & ~(leaf_side - 1);
    for (std::int64_t z = lo.z; z < box_.hi.z; z += leaf_side)
      for (std::int64_t y = lo.y; y < box_.hi.y; y += leaf_side)
        for (std::int64_t x = lo.x; x < box_.hi.x; x += leaf_side) {
          const Index3 cell{x, y, z};
          f(cell, intersect(box_, {cell, cell + splat(leaf_side)}));
        }
  }
  template <class F>
  void each(const Box3& part, F&& value) const {
    const Index3 size = box_.size();
    for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
      for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
        Sample* row = out_ + ((z - box_.lo.z) * size.y + (y - box_.lo.y)) * size.x - box_.lo.x;
        for (std::int64_t x = part.lo.x; x < part.hi.x; ++x) row[x] = value({x, y, z});
      }
  }

  const Grid& grid_;
  typename Grid::ConstAccessor access_;
  Box3 box_;
  Sample* out_;
};

// What is decoded of leaves stays with them. In a child of its own it goes with that.
void read_box(const openvdb::GridBase& grid, VdbTalk& talk) {
  with_grid(grid, [&](const auto& of_type, auto sample) {
    Filling filling(of_type, talk.box, reinterpret_cast<decltype(sample)*>(talk.samples));
    if (filling.any_leaf())
      ChildService::apart([&] { filling.fill(); }, rules_of_reading);
    else
      filling.fill();
  });
}

}  // namespace

struct VdbLibrary::State {
  std::unique_ptr<openvdb::io::File> file;
  std::vector<std::string> names;
  openvdb::GridBase::ConstPtr grid;

  void survey(const std::string& path, VdbTalk& talk);
  void open(VdbTalk& talk);
};

void VdbLibrary::State::survey(const std::string& path, VdbTalk& talk) {
  openvdb::initialize();
  std::ifstream stream(path, std::ios::binary);
  talk.needed_bytes = GridList().end(stream);
  if (talk.needed_bytes > talk.file_bytes) return;  // cut short: the program says so
  file = std::make_unique<openvdb::io::File>(path);
  file->setCopyMaxBytes(0);  // else it copies the file first
  file->open();
  for (auto name = file->beginName(); name != file->endName(); ++name) names.push_back(*name);
  if (names.size() > most_vdb_grids)
    throw std::runtime_error("it has " + std::to_string(names.size()) + " grids; expected " +
                             std::to_string(most_vdb_grids) + " at most");
  for (const std::string& name : names)
    describe(name, *file->readGridMetadata(name), talk.grid[talk.grids++]);
}

void VdbLibrary::State::open(VdbTalk& talk) {
  grid = file->readGrid(names.at(talk.chosen));
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  talk.active = !box.empty();
  keep(talk.first, box.min());
  keep(talk.last, box.max());
  with_grid(*grid, [&](const auto& of_type, auto) { talk.tree_bytes = of_type.tree().memUsage(); });
}

VdbLibrary::VdbLibrary(std::string path)
    : path_(std::move(path)), state_(std::make_unique<State>()) {}
VdbLibrary::~VdbLibrary() = default;

void VdbLibrary::answer(VdbTalk& talk) {
  switch (talk.task) {
    case VdbTask::survey:
      return state_->survey(path_, talk);
    case VdbTask::open:
      return state_->open(talk);
    case VdbTask::read:
      return read_box(*state_->grid, talk);
  }
}

}  // namespace voxweld
