#include "stages/encode/mesh_streams.h"

#include <gmock/gmock.h>

#include <sstream>

#include "stages/encode/corner_points.h"
#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_accumulator.h"
#include "storage/support/error.h"
#include "tests/support/error_text.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

using testing::cut_into_tiles;
using ::testing::HasSubstr;

TileMesh streamed_torus() {
  return testing::make_torus({.around = 60, .across = 30}, testing::small_lattice());
}

EachTile each_of(const std::vector<TileMesh>& tiles) {
  return [&tiles](const auto& f) {
    for (const TileMesh& tile : tiles) f(tile);
  };
}

using Stream = void (*)(const EachTile&, const StreamTotals&, const ByteSink&);

std::vector<std::byte> streamed(Stream stream, const std::vector<TileMesh>& tiles) {
  std::vector<std::byte> file;
  stream(each_of(tiles), totals_of(each_of(tiles)), [&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
  });
  return file;
}

std::string text_of(std::span<const std::byte> file) {
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

TileMesh joined(const std::vector<TileMesh>& tiles) {
  MeshAccumulator accumulator;
  for (const TileMesh& tile : tiles) accumulator.append(tile);
  return accumulator.take();
}

TriangleDigest digest_of(const TileMesh& mesh) {
  LatticeMesh lattice{mesh.positions, mesh.triangles};
  for (const std::uint32_t pair : mesh.triangle_pairs) lattice.pairs.push_back(mesh.pairs[pair]);
  return digest(lattice);
}

// Pairs by where a triangle lies, so that vertices lie between several.
TileMesh between_labels(TileMesh mesh, const std::vector<MaterialPair>& pairs) {
  mesh.pairs = pairs;
  mesh.triangle_pairs.clear();
  for (const auto& t : mesh.triangles)
    mesh.triangle_pairs.push_back(static_cast<std::uint32_t>(
        static_cast<std::size_t>(mesh.positions[t[0]][0] / 300) % pairs.size()));
  return mesh;
}
std::vector<TileMesh> tiles_between_labels(const std::vector<MaterialPair>& pairs) {
  std::vector<TileMesh> tiles = cut_into_tiles(streamed_torus(), 3);
  for (TileMesh& tile : tiles) tile = between_labels(std::move(tile), pairs);
  return tiles;
}

TEST(TileWelder, NumbersAsTheAccumulatorDoes) {
  for (const int level : {2, 3, 4, 6}) {
    const auto tiles = cut_into_tiles(streamed_torus(), level);
    const TileMesh whole = joined(tiles);
    TileWelder welder;
    std::vector<LatticePoint> positions;
    std::size_t triangle = 0;
    for (const TileMesh& tile : tiles) {
      welder.add(tile);
      for (const std::uint32_t v : welder.fresh()) positions.push_back(tile.positions[v]);
      for (const auto& t : tile.triangles) {
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_EQ(welder.numbers()[t[k]], whole.triangles[triangle][k]);
        ++triangle;
      }
    }
    EXPECT_EQ(positions, whole.positions);
    EXPECT_EQ(welder.vertices(), whole.positions.size());
    EXPECT_EQ(welder.triangles(), whole.triangles.size());
  }
}

TEST(TileWelder, KeepsWhatLiesAtBordersAlone) {
  const auto tiles = cut_into_tiles(
      testing::make_torus({.around = 400, .across = 200}, testing::small_lattice()), 4);
  TileWelder welder;
  std::uint64_t planned = 0, vertices = 0;
  for (const TileMesh& tile : tiles) {
    welder.add(tile);
    vertices += tile.positions.size();
    planned += TileWelder::kept_bytes(tile.positions.size(), false);
  }
  EXPECT_GT(welder.kept(), 0u);
  EXPECT_LT(welder.kept(), vertices / 10);
  EXPECT_LT(welder.kept() * 32, planned);
}

TEST(TileWelder, JoinsWhereTrianglesOfOtherTilesSeparateOtherLabels) {
  const auto tiles = tiles_between_labels({{1, 2}, {1, 3}, {2, 3}});
  TileWelder welder;
  for (const TileMesh& tile : tiles) welder.add(tile);
  EXPECT_EQ(welder.vertices(), joined(tiles).positions.size());
}

TEST(TileWelder, RefusesTilesThatDoNotBelongTogether) {
  const auto tiles = cut_into_tiles(streamed_torus(), 3);
  const auto refused = [&](auto change) {
    TileWelder welder;
    welder.add(tiles[0]);
    return testing::error_text<InputError>([&] {
      for (std::size_t i = 1; i < tiles.size(); ++i) {
        TileMesh other = tiles[i];
        change(other);
        welder.add(other);
      }
    });
  };
  EXPECT_THAT(refused([](TileMesh& m) { m.lattice.bits = 15; }), HasSubstr("different output"));
  EXPECT_THAT(refused([&](TileMesh& m) {
                for (auto& q : m.positions) q = tiles[0].positions[0];
              }),
              HasSubstr("is at ("));
}

TEST(MeshStreams, DoNotDependOnWhereTheMeshIsCut) {
  const TileMesh in_order = joined(cut_into_tiles(streamed_torus(), 2));
  for (const Stream stream : {stream_ply, stream_stl})
    for (const int level : {3, 4, 6})
      EXPECT_EQ(streamed(stream, cut_into_tiles(in_order, level)), streamed(stream, {in_order}));
}

TEST(MeshStreams, AreReadAsTheyWereWritten) {
  const TileMesh mesh = streamed_torus();
  const auto tiles = cut_into_tiles(mesh, 3);
  const std::map<std::string, Stream> formats = {
      {"ply", stream_ply}, {"stl", stream_stl}, {"obj", stream_obj}};
  for (const auto& [format, stream] : formats) {
    const DecodedMesh read = decode_mesh_file(streamed(stream, tiles), format, "file");
    EXPECT_EQ(digest(weld(read, mesh.lattice)), digest_of(mesh)) << format;
    EXPECT_EQ(read.positions.size(),
              format == "stl" ? 3 * mesh.triangles.size() : mesh.positions.size())
        << format;
  }
}

TEST(MeshStreams, PlyHasTheLabelsOfFaces) {
  const Material large = (Material{1} << 40) + 1;
  for (const auto& pairs : {std::vector<MaterialPair>{{0, 7}, {3, exterior}, {7, 9}},
                            std::vector<MaterialPair>{{0, large}, {3, exterior}}}) {
    const TileMesh mesh = between_labels(streamed_torus(), pairs);
    const auto file = streamed(stream_ply, tiles_between_labels(pairs));
    EXPECT_THAT(text_of(file),
                HasSubstr(pairs.size() == 3 ? "property int label\n" : "property double label\n"));
    const DecodedMesh read = decode_mesh_file(file, "ply", "file");
    EXPECT_EQ(digest(weld(read, mesh.lattice)), digest_of(mesh));
  }
  EXPECT_THAT(testing::error_text<InputError>([] {
                streamed(stream_ply, tiles_between_labels({{1, (Material{1} << 53) + 1}}));
              }),
              HasSubstr("label 9007199254740993"));
}

TEST(MeshStreams, ObjHasTheNormalOfEachCorner) {
  const TileMesh mesh = streamed_torus();
  const auto tiles = cut_into_tiles(mesh, 3);
  std::istringstream lines(text_of(streamed(stream_obj, tiles)));
  std::vector<Vec3> normals;
  std::size_t tile = 0, triangle = 0;
  for (std::string word; lines >> word;) {
    if (word == "vn") {
      Vec3& n = normals.emplace_back();
      lines >> n.x >> n.y >> n.z;
    }
    if (word != "f") continue;
    for (std::size_t k = 0; k < 3; ++k) {
      std::string corner;
      lines >> corner;
      const std::size_t number = std::stoull(corner.substr(corner.find("//") + 2));
      ASSERT_LE(number, normals.size());
      const TileMesh& from = tiles[tile];
      const Vec3 expected =
          from.corner_normals[triangle][k].of(from.normals[from.triangles[triangle][k]]);
      EXPECT_GT(dot(normals[number - 1], expected), 0.9999);
    }
    if (++triangle == tiles[tile].triangles.size()) ++tile, triangle = 0;
  }
  EXPECT_EQ(tile, tiles.size());
}

TEST(MeshStreams, SayWhatTheirFormatsCannotCount) {
  const auto refused = [](Stream stream, const StreamTotals& totals) {
    return testing::error_text<InputError>(
        [&] { stream([](const auto&) {}, totals, [](std::span<const std::byte>) {}); });
  };
  StreamTotals totals;
  totals.vertices = totals.triangles = std::uint64_t{1} << 32;
  EXPECT_THAT(refused(stream_ply, totals), HasSubstr("4294967296"));
  EXPECT_THAT(refused(stream_stl, totals), HasSubstr("4294967296"));
}

TEST(MeshStreams, DamagedFilesAreNamed) {
  auto file = streamed(stream_ply, {streamed_torus()});
  file.resize(file.size() / 2);
  EXPECT_THAT(testing::error_text<FormatError>([&] { decode_mesh_file(file, "ply", "a.ply"); }),
              ::testing::StartsWith("a.ply: "));
}

TEST(CornerPoints, AreVerticesWhereThereAreNoNormals) {
  TileMesh mesh = testing::make_cube(testing::small_lattice(), {4, 4, 4}, 8, 2);
  EXPECT_EQ(corner_points(mesh, false).positions.size(), mesh.positions.size());
  // 9 points a face, each with that face's normal.
  const DecodedMesh points = corner_points(mesh, true);
  EXPECT_EQ(points.positions.size(), 54u);
  EXPECT_EQ(points.normals.size(), 54u);
  EXPECT_EQ(digest(weld(points, mesh.lattice)), digest_of(mesh));
}

}  // namespace
}  // namespace voxweld
