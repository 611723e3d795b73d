// The paper's figure 1: balls of radius 6 taken out of a contoured model, one after the other, each
// contoured at once.
// usage: paper_cuts [OPTION...] CONFIG
// Prints the time of a cut: CSG on the Hermite data of the bricks it reaches, which are kept as the
// paper keeps its octree, simplifying these bricks, and stitching the tiles they are part of.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <set>
#include <tuple>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/paper/drawing.h"
#include "tests/paper/staged_contour.h"
#include "tests/paper/stopwatch.h"

namespace {

using namespace voxweld;
using namespace voxweld::paper;

class CutModel {
 public:
  explicit CutModel(const ModelVolume& model)
      : model_(model),
        hermite_(hermite_data(model, Homogeneous::keep)),
        simplifier_(model),
        bricks_(no_bricks(model)) {
    for (const HermiteBrick& brick : hermite_) simplify(brick);
    update_tiles(nullptr);
  }

  struct Cost {
    double csg = 0, simplify = 0, stitch = 0;  // milliseconds
    std::size_t bricks = 0, tiles = 0;
    double total() const { return csg + simplify + stitch; }
  };
  Cost cut(const Edit& edit) {
    Cost cost;
    std::vector<HermiteBrick*> reached;
    cost.csg = processor_ms([&] {
      for (HermiteBrick& brick : hermite_)
        if (edit_reaches(edit, bounds_of_brick(brick))) reached.push_back(&brick);
      for (HermiteBrick* brick : reached) apply(edit, model_, *brick);
    });
    cost.simplify = processor_ms([&] {
      for (const HermiteBrick* brick : reached) simplify(*brick);
    });
    std::vector<Box3> changed;
    changed.reserve(reached.size());
    for (const HermiteBrick* brick : reached) changed.push_back(brick_cells(brick->at));
    cost.stitch = processor_ms([&] { cost.tiles = update_tiles(&changed); });
    cost.bricks = reached.size();
    return cost;
  }

  std::vector<TileMesh> tiles() const {
    std::vector<TileMesh> all;
    for (const auto& [key, tile] : tiles_) all.push_back(tile.mesh);
    return all;
  }

 private:
  struct Tile {
    PlannedTile plan;
    TileMesh mesh;
  };

  Bounds bounds_of_brick(const HermiteBrick& brick) const {
    return brick_bounds({brick.frame.origin, brick.frame.level}, model_.parameters.spacing);
  }
  void simplify(const HermiteBrick& brick) {
    simplifier_.simplify(brick, bricks_.octrees[morton_encode(brick.at)]);
  }

  Box3 brick_cells(Index3 brick) const {
    const BrickPlace place = place_of_brick(bricks_.grid(), brick);
    return {place.origin, place.origin + splat(std::int64_t{1} << place.level)};
  }
  static Box3 cells(CellKey key) {
    const std::int64_t side = std::int64_t{1} << key.level;
    return {key.at * side, (key.at + splat(1)) * side};
  }

  // Leaves above the bricks that came or went: all below them has other vertices.
  static void add_difference(const std::vector<TopLeaf>& a, const std::vector<TopLeaf>& b,
                             std::vector<Box3>& changed) {
    const auto same = [](const TopLeaf& p, const TopLeaf& q) {
      return p.code == q.code && p.level == q.level && p.vertex.offset == q.vertex.offset;
    };
    const auto lower = [](const TopLeaf& p, const TopLeaf& q) { return p.code < q.code; };
    for (const TopLeaf& leaf : a) {
      const auto found = std::lower_bound(b.begin(), b.end(), leaf, lower);
      if (found == b.end() || !same(*found, leaf)) changed.push_back(cells(leaf.key()));
    }
  }
  // The same where each sheet collapses by itself.
  static void add_difference(const std::vector<ClusterLeaf>& a, const std::vector<ClusterLeaf>& b,
                             std::vector<Box3>& changed) {
    const auto parts = [](const ClusterLeaf& leaf) {
      return std::tuple(leaf.level, leaf.first, leaf.shares, leaf.vertex.offset);
    };
    std::set<decltype(parts(a[0]))> known;
    for (const ClusterLeaf& leaf : b) known.insert(parts(leaf));
    for (const ClusterLeaf& leaf : a)
      if (!known.contains(parts(leaf))) changed.push_back(cells(leaf.key()));
  }

  // Whether the tile's polygons, which reach one cell into what lies above it, meet the changes.
  static bool touched(const PlannedTile& tile, const std::vector<Box3>& changed) {
    Box3 reach = cells(tile.key());
    reach.hi = reach.hi + splat(1);
    return std::any_of(changed.begin(), changed.end(),
                       [&](const Box3& box) { return !intersect(box, reach).empty(); });
  }

  // Stitches what is new or touched; all where `changed` is null. Returns how many.
  std::size_t update_tiles(std::vector<Box3>* changed) {
    VolumeContour contour = plan_tiles(bricks_);
    if (changed != nullptr) {
      add_difference(top_, contour.top, *changed);
      add_difference(contour.top, top_, *changed);
      add_difference(above_, contour.above.leaves, *changed);
      add_difference(contour.above.leaves, above_, *changed);
    }
    std::map<std::uint64_t, Tile> before;
    std::swap(before, tiles_);
    std::size_t stitched = 0;
    for (const PlannedTile& plan : contour.plan) {
      const auto old = before.find(plan.code);
      const bool keep = changed != nullptr && old != before.end() &&
                        old->second.plan.level == plan.level && !touched(plan, *changed);
      if (keep) {
        tiles_.emplace(plan.code, std::move(old->second));
        continue;
      }
      tiles_[plan.code] = {plan, stitch_tile(bricks_, contour, plan)};
      ++stitched;
    }
    top_ = std::move(contour.top);
    above_ = std::move(contour.above.leaves);
    return stitched;
  }

  const ModelVolume& model_;
  std::vector<HermiteBrick> hermite_;
  Simplifier simplifier_;
  VolumeBricks bricks_;
  std::vector<TopLeaf> top_;
  std::vector<ClusterLeaf> above_;
  std::map<std::uint64_t, Tile> tiles_;
};

// Vertices of the surface as it is, spread over it by their numbers.
std::vector<Edit> balls_on(const std::vector<TileMesh>& tiles, std::size_t count, double radius) {
  std::vector<Vec3> places;
  for (const TileMesh& tile : tiles)
    for (const LatticePoint& p : tile.positions)
      places.push_back(testing::place_of(tile.lattice, p));
  std::vector<Edit> balls(count);
  for (std::size_t i = 0; i < count; ++i) {
    balls[i].op = EditOp::subtract;
    balls[i].solid.shape = SolidShape::sphere;
    balls[i].solid.radius = radius;
    balls[i].solid.center = places[(2 * i + 1) * places.size() / (2 * count)];
  }
  return balls;
}

void write_places(const std::vector<Edit>& cuts, const std::filesystem::path& file) {
  std::string text;
  for (const Edit& cut : cuts) {
    const Vec3 c = cut.solid.center;
    text += fmt::format("{},{},{}\n", c.x, c.y, c.z);
  }
  write_whole_file(file, as_bytes(text), Durability::rename_only);
}

// Whether what stands after the cuts is what comes of the same edits from the start.
void check(const ModelVolume& model, const std::vector<Edit>& cuts,
           const std::vector<TileMesh>& tiles) {
  ModelVolume edited = model;
  edited.parameters.edits.insert(edited.parameters.edits.end(), cuts.begin(), cuts.end());
  const std::vector<TileMesh> anew = contour_bricks(build_bricks(edited)).tiles;
  bool same = anew.size() == tiles.size();
  for (std::size_t i = 0; same && i < anew.size(); ++i)
    same = anew[i].positions == tiles[i].positions && anew[i].triangles == tiles[i].triangles;
  if (!same) throw std::logic_error("cuts one by one do not give what all at once give");
}

void print(const std::string& name, const std::vector<CutModel::Cost>& costs) {
  std::vector<double> totals, csg, simplify, stitch;
  double bricks = 0, tiles = 0;
  for (const CutModel::Cost& cost : costs) {
    totals.push_back(cost.total());
    csg.push_back(cost.csg);
    simplify.push_back(cost.simplify);
    stitch.push_back(cost.stitch);
    bricks += static_cast<double>(cost.bricks);
    tiles += static_cast<double>(cost.tiles);
  }
  const auto n = static_cast<double>(costs.size());
  fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", name,
             costs.size(), median_of(totals), *std::max_element(totals.begin(), totals.end()),
             median_of(csg), median_of(simplify), median_of(stitch), bricks / n, tiles / n);
}

}  // namespace

int main(int argc, char** argv) try {
  std::string config, name, before, after, places;
  std::vector<std::string> overrides;
  std::size_t count = 24;
  double radius = 6;
  Drawing drawing;
  CLI::App app("Times balls taken out of a contoured model");
  app.add_option("config", config)->required();
  app.add_option("--name", name)->required();
  app.add_option("--set", overrides, "table.key=value");
  app.add_option("--cuts", count)->capture_default_str();
  app.add_option("--radius", radius)->capture_default_str();
  app.add_option("--width", drawing.options.width, "Pixels")->capture_default_str();
  app.add_option("--height", drawing.options.height, "Pixels")->capture_default_str();
  app.add_option("--before", before, "PNG to write");
  app.add_option("--after", after, "PNG to write");
  app.add_option("--places", places, "File to write the balls' centres to, x,y,z a line");
  CLI11_PARSE(app, argc, argv);
  const ModelVolume model = load_model(config, overrides);
  CutModel cut_model(model);
  const std::vector<Edit> cuts = balls_on(cut_model.tiles(), count, radius);
  if (!before.empty()) draw(cut_model.tiles(), drawing, before);
  if (!places.empty()) write_places(cuts, places);
  std::vector<CutModel::Cost> costs;
  costs.reserve(cuts.size());
  for (const Edit& edit : cuts) costs.push_back(cut_model.cut(edit));
  if (!after.empty()) draw(cut_model.tiles(), drawing, after);
  check(model, cuts, cut_model.tiles());
  print(name, costs);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
