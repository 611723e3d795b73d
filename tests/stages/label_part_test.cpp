// Edits of one label by itself and of all of them at once put every lattice point on the same side.
#include "stages/build/label_part.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>

#include "stages/build/label_bricks.h"
#include "stages/build/label_edits.h"

namespace voxweld {
namespace {

constexpr Material unmet = 9;  // no sample is of it

struct Random {
  std::mt19937 engine;
  int below(int end) { return static_cast<int>(engine() % static_cast<unsigned>(end)); }
  double within(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(engine);
  }
};

Solid random_solid(Random& random, Index3 size) {
  Solid solid;
  solid.shape = std::array{SolidShape::sphere, SolidShape::box, SolidShape::plane,
                           SolidShape::cylinder}[static_cast<std::size_t>(random.below(4))];
  for (int a = 0; a < 3; ++a) {
    solid.center[a] = random.within(-3, static_cast<double>(size[a]) + 3);
    solid.size[a] = random.within(1, 40);
  }
  solid.radius = random.within(0.5, 20);
  solid.height = random.within(1, 40);
  return solid;
}

Edits random_edits(Random& random, Index3 size) {
  // At times more than are kept.
  Edits edits(static_cast<std::size_t>(1 + random.below(random.below(8) == 0 ? 12 : 4)));
  for (Edit& edit : edits) {
    edit.op = static_cast<EditOp>(random.below(4));
    edit.solid = random_solid(random, size);
    if (edit.op == EditOp::add || edit.op == EditOp::replace)
      edit.material = random.below(4) == 0 ? unmet : static_cast<Material>(random.below(5));
  }
  return edits;
}

struct Volume {
  Index3 size;
  std::vector<std::uint8_t> samples;
  HaloBlock block() const {
    return {SampleType::u8, size,
            {{}, size},     reinterpret_cast<const std::byte*>(samples.data()),
            size.x,         size.x * size.y};
  }
};

// Labels 0 .. 4 in slabs and blocks with some noise; 4 is of nothing.
Volume random_volume(Random& random) {
  Volume volume{{5 + random.below(40), 5 + random.below(40), 5 + random.below(40)}, {}};
  const int across = 3 + random.below(20);
  each_index(volume.size, [&](Index3 s) {
    volume.samples.push_back(static_cast<std::uint8_t>(
        random.below(30) == 0 ? random.below(5) : (s.x / across + s.y / 9 + 2 * (s.z / 13)) % 5));
  });
  return volume;
}

MaterialRules rules() {
  MaterialRules rules;
  rules.ranges.push_back({4, 4, false, exterior});
  return rules;
}

std::vector<const Edit*> reaching(const Edits& edits, const BrickPlace& place, Vec3 spacing) {
  std::vector<const Edit*> found;
  for (const Edit& edit : edits)
    if (edit_reaches(edit, brick_bounds(place, spacing))) found.push_back(&edit);
  return found;
}

// All labels at once, as labels.mode = "shared" has them.
LabelGrid edited_grid(const MaterialBlock& materials, const BrickPlace& place,
                      const std::vector<const Edit*>& edits, const VolumeFrame& frame) {
  const int side = 1 << place.level;
  LabelGrid grid;
  HermiteEdges edges;
  grid.fill(materials, place.origin, side);
  edges.find(grid);
  LabelEdits apply;
  for (const Edit* edit : edits) apply.apply(*edit, frame, place.origin, grid, edges);
  return grid;
}

void expect_same_sides(const Volume& volume, const BrickPlace& place, const Edits& edits,
                       const ContourParameters& common) {
  MaterialBlock materials;
  materials.fill(volume.block(), rules(), std::array<Material, 6>{0, 1, 2, 3, 4, unmet});
  const int side = 1 << place.level;
  const VolumeFrame frame{volume.size, common.spacing};
  const auto applied = reaching(edits, place, common.spacing);
  const LabelGrid grid = edited_grid(materials, place, applied, frame);
  LabelExtents extents;
  const auto count = static_cast<std::uint32_t>(materials.materials().size());
  const auto span = extents.find(materials.block(), place, count, materials.outside());
  const std::vector<std::uint32_t> found(span.begin(), span.end());
  SolidSides solids;
  solids.begin(applied, frame, place.origin, side);
  for (std::uint32_t label = 0; label + 1 < count; ++label) {
    const bool in_samples = std::find(found.begin(), found.end(), label) != found.end();
    LabelPart part(materials.materials()[label], place,
                   in_samples ? extents.samples(label) : Box3{}, applied, solids, common.spacing);
    if (part.replaces()) part.set_any(&materials.any());
    ContourParameters parameters = common;
    parameters.surface.label = label;
    BrickSurface surface, any;
    surface.find_signs(materials.block(), part.window(), parameters.surface);
    const bool edited = part.apply_edits(materials.block(), parameters, surface, any);
    ASSERT_LE(edited, part.is_edited());
    for (int z = 0; z <= side; ++z)
      for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x)
          ASSERT_EQ(surface.signs().inside(x, y, z), grid.at(x, y, z) == label)
              << "label " << label << " at " << x << " " << y << " " << z;
    if (!edited) continue;
    // And every side change has a crossing.
    for (int x = 0; x < side; ++x) {
      const bool crosses = (grid.at(x, 1, 1) == label) != (grid.at(x + 1, 1, 1) == label);
      ASSERT_EQ(surface.edges().has(0, x, 1, 1), crosses);
    }
  }
}

RC_GTEST_PROP(LabelPart, HasTheSidesOfAllLabelsAtOnce, (const unsigned seed)) {
  Random random{std::mt19937(seed)};
  const Volume volume = random_volume(random);
  const Edits edits = random_edits(random, volume.size);
  ContourParameters parameters;
  parameters.spacing = {1, 0.9, 1.3};
  const Index3 bricks{volume.size.x / 16 + 1, volume.size.y / 16 + 1, volume.size.z / 16 + 1};
  each_index(bricks, [&](Index3 at) {
    expect_same_sides(volume, {at * 16, 4}, edits, parameters);
  });
  RC_ASSERT(!::testing::Test::HasFailure());
}

template <class T>
std::string raw_bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// What the whole brick gives is what each label's own window does: no vertex or crossing lacks.
RC_GTEST_PROP(LabelPart, DoesNotDependOnItsWindow, (const unsigned seed)) {
  Random random{std::mt19937(seed)};
  const Volume volume = random_volume(random);
  const Edits edits = random_edits(random, volume.size);
  const BrickPlace place{{16, 0, 16}, 4};
  ContourParameters parameters;
  parameters.labels.mode = LabelMode::each;
  parameters.labels.rules = std::make_shared<const MaterialRules>(rules());
  parameters.edits = edits;
  LabelBricks bricks;
  bricks.fill(volume.block(), parameters);
  const auto applied = reaching(edits, place, parameters.spacing);
  BrickScratch scratch;
  bricks.each(place, parameters, [&](Material material, const BrickOctree& octree) {
    if (material == 4) return;  // the volume's own are not chosen
    ContourParameters alone;
    alone.surface.label = material;
    for (const Edit* edit : applied) {
      const bool gives = edit->op == EditOp::add || edit->op == EditOp::replace;
      if (edit->op == EditOp::replace && edit->material == material) return;  // not of one label
      alone.edits.push_back(*edit);
      if (gives && edit->material != material) alone.edits.back().op = EditOp::subtract;
    }
    BrickOctree expected;
    build_brick(volume.block(), place, alone, scratch, expected);
    EXPECT_EQ(octree.root.state, expected.root.state) << "label " << material;
    EXPECT_TRUE(raw_bytes(octree.vertices) == raw_bytes(expected.vertices)) << "label " << material;
    EXPECT_TRUE(raw_bytes(octree.polygons) == raw_bytes(expected.polygons)) << "label " << material;
  });
  RC_ASSERT(!::testing::Test::HasFailure());
}

RC_GTEST_PROP(MaterialAfter, IsThatOfEveryPoint, (const unsigned seed)) {
  Random random{std::mt19937(seed)};
  const Edits edits = random_edits(random, {30, 30, 30});
  Bounds box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = random.within(0, 25);
    box.hi[a] = box.lo[a] + random.within(0, 6);
  }
  const std::array<std::optional<Material>, 3> before = {std::nullopt, exterior, Material{2}};
  for (const auto& start : before) {
    const auto after = material_after(edits, box, start);
    if (!after) continue;
    for (int i = 0; i < 27; ++i) {
      const Vec3 t{0.5 * (i % 3), 0.5 * (i / 3 % 3), 0.5 * (i / 9)};
      Vec3 p;
      for (int a = 0; a < 3; ++a) p[a] = box.lo[a] + t[a] * (box.hi[a] - box.lo[a]);
      Material at = start.value_or(77);
      for (const Edit& edit : edits) {
        const bool in = solid_holds(edit.solid, p);
        if (edit.op == EditOp::intersect ? in : !in) continue;
        if (edit.op == EditOp::replace && at == exterior) continue;
        at = edit.material;
      }
      RC_ASSERT(at == *after);
    }
  }
}

}  // namespace
}  // namespace voxweld
