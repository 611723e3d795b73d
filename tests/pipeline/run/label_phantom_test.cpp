// Labels with exact interfaces, meshed: how far triangles lie from the interface of their pair.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/output/load.h"
#include "pipeline/phantom/junctions_field.h"
#include "storage/types/label_range.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

constexpr std::int64_t n = 96;
constexpr std::uint64_t first_id = highest_label - 6;  // ids that only 64 bits hold

// Of the phantom's labels; what is outside is 0 there.
std::uint64_t label_of(Material material) {
  return material == exterior ? 0 : material - first_id + 1;
}

struct Distances {
  double sum = 0, most = 0, off_curves = 0;
  std::uint64_t count = 0;
};

// A ball of three wedges, two radii and three half circles, and one of four cells, four radii and six
// arcs between them.
const double true_length = 0.2 * n * (2 + 3 * std::numbers::pi + 4 + 6 * std::acos(-1.0 / 3));

struct Lines {
  double length = 0;
  double mean = 0, most = 0;  // distance from the true lines, along the length
};

// Edges of three triangles and more.
Lines lines_of(const DecodedMesh& decoded, const JunctionsField& field) {
  using Place = std::array<float, 3>;  // shading may have cut a vertex in several
  std::map<std::array<Place, 2>, std::size_t> around;
  for (const auto& t : decoded.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] =
          std::minmax(decoded.positions[t[k]], decoded.positions[t[(k + 1) % 3]]);
      ++around[{low, high}];
    }
  Lines lines;
  for (const auto& [edge, count] : around) {
    if (count == 2) continue;
    const Vec3 a{edge[0][0], edge[0][1], edge[0][2]}, b{edge[1][0], edge[1][1], edge[1][2]};
    const double length = std::sqrt(dot(b - a, b - a));
    lines.length += length;
    for (const double at : {0.0, 0.25, 0.5, 0.75}) {
      const double d = field.curve_distance(a + (b - a) * at);
      lines.mean += length * d / 4;
      lines.most = std::max(lines.most, d);
    }
  }
  lines.mean /= lines.length;
  return lines;
}

TEST(LabelPhantom, TrianglesLieOnTheInterfaceOfTheirPair) {
  const Scene scene("sphere", 8);  // for its folders
  const std::string volume = (scene.directory() / "junctions.nrrd").string();
  VOXWELD_EXPECT_DONE(
      run_voxweld({"phantom", "junctions", "--size", std::to_string(n), "--type", "uint64",
                   "--first-label", std::to_string(first_id), "-o", volume}));
  for (const char* refine : {"off", "collapse"}) {
    SCOPED_TRACE(refine);
    VOXWELD_EXPECT_DONE(
        scene.run({"input.path=" + volume, "labels.mode=shared", "surface.inside=above",
                   std::string("simplify.refine=") + refine}));
    expect_good(scene.output());
    const DecodedMesh mesh = load_mesh(scene.output() / "mesh.drc");
    ASSERT_EQ(mesh.triangle_pairs.size(), mesh.triangles.size());
    const JunctionsField field(n);
    Distances vertices;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const MaterialPair pair = mesh.pairs[mesh.triangle_pairs[t]];
      for (const std::uint32_t corner : mesh.triangles[t]) {
        const auto& p = mesh.positions[corner];
        const Vec3 at{p[0], p[1], p[2]};
        const double d =
            field.interface_distance(at, label_of(pair.inside), label_of(pair.outside));
        vertices.sum += d;
        vertices.most = std::max(vertices.most, d);
        if (field.curve_distance(at) > 3) vertices.off_curves = std::max(vertices.off_curves, d);
        ++vertices.count;
      }
    }
    fmt::print("mean {:.4f}, most {:.4f}, away from curves {:.4f} voxels\n",
               vertices.sum / static_cast<double>(vertices.count), vertices.most,
               vertices.off_curves);
    EXPECT_LT(vertices.sum / static_cast<double>(vertices.count), 0.15);
    EXPECT_LT(vertices.off_curves, 0.6);
    EXPECT_LT(vertices.most, 1.5);
    // Where three labels meet.
    const Lines now = lines_of(mesh, field);
    fmt::print("{} triangles, lines of {:.1f} voxels, mean {:.4f}, most {:.4f} voxels off\n",
               mesh.triangles.size(), now.length, now.mean, now.most);
    EXPECT_LT(now.mean, 0.3);
    EXPECT_LT(now.most, 1);
    // They run along, not to and fro: refined no more than before.
    EXPECT_NEAR(now.length, true_length, 0.01 * true_length);
  }
}

}  // namespace
}  // namespace voxweld::testing
