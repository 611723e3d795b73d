// Meshes between labels through Draco and glTF: the pairs come back, and nothing is lost where
// three triangles meet in an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "stages/encode/glb.h"
#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/pair_meshes.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

constexpr Material high = 0xfffffffffffffffeu;

// A book: sheets of squares that meet in one row of edges, each sheet between two labels.
TileMesh book(int sheets, int length) {
  TileMesh mesh;
  mesh.lattice = testing::small_lattice();
  const auto vertex = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    mesh.positions.push_back({x, y, z});
    mesh.ids.push_back(VertexId::make({0, {x, y, z}}, 0));
    mesh.normals.push_back(
        {pack_normal({1, 0, 0}), pack_normal({0, 1, 0}), pack_normal({0, 0, 1})});
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  std::vector<std::uint32_t> spine;
  for (int i = 0; i <= length; ++i) spine.push_back(vertex(50, 50, 10 + i));
  for (int s = 0; s < sheets; ++s) {
    mesh.pairs.push_back(
        {static_cast<Material>(s), s == 0 ? exterior : high - static_cast<Material>(s)});
    std::vector<std::uint32_t> rim;
    for (int i = 0; i <= length; ++i) rim.push_back(vertex(60 + s, 20 + s * 7 % 23, 10 + i));
    for (std::size_t i = 0; i < static_cast<std::size_t>(length); ++i)
      for (const auto& t : {std::array{spine[i], rim[i], spine[i + 1]},
                            std::array{rim[i], rim[i + 1], spine[i + 1]}}) {
        mesh.triangles.push_back(t);
        const bool turned = (s + mesh.triangles.size()) % 2 != 0;
        mesh.corner_normals.push_back({CornerNormal::make(s % 3, turned),
                                       CornerNormal::make(0, false),
                                       CornerNormal::make(1, turned)});
        mesh.triangle_pairs.push_back(static_cast<std::uint32_t>(s));
      }
  }
  return mesh;
}

LatticeMesh with_pairs(const TileMesh& mesh) {
  LatticeMesh out{mesh.positions, mesh.triangles, {}};
  for (const std::uint32_t pair : mesh.triangle_pairs) out.pairs.push_back(mesh.pairs[pair]);
  return out;
}

std::vector<std::byte> glb_of(const TileMesh& mesh, const EncodeParameters& parameters) {
  const std::vector<TileMesh> meshes = split_by_pair(mesh);
  std::vector<GlbPart> parts;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    parts.push_back({encode_draco(meshes[i], parameters), mesh.pairs[i]});
  return wrap_glb(parts, {});
}

TEST(Pairs, ComeBackFromBothFormats) {
  for (const int sheets : {1, 2, 3, 5, 40})
    for (const bool normals : {false, true}) {
      const TileMesh mesh = book(sheets, 12);
      EncodeParameters parameters;
      parameters.normals = normals;
      const TriangleDigest expected = digest(with_pairs(mesh));
      const EncodedMesh encoded = encode_draco(mesh, parameters);
      EXPECT_GE(encoded.pair_id, 0);
      const LatticeMesh drc = weld(decode_draco(encoded.bytes), mesh.lattice);
      EXPECT_EQ(digest(drc), expected) << sheets;
      EXPECT_EQ(drc.positions.size(), mesh.positions.size());
      const LatticeMesh glb = weld(decode_glb(glb_of(mesh, parameters)), mesh.lattice);
      EXPECT_EQ(digest(glb), expected) << sheets;
      EXPECT_EQ(encode_draco(mesh, parameters).bytes, encoded.bytes);
    }
}

// A triangle's corners by place, each with its normal to a tenth.
using ShadedTriangle = std::array<std::array<int, 6>, 3>;
ShadedTriangle shaded(const std::array<LatticePoint, 3>& places,
                      const std::array<Vec3, 3>& normals) {
  ShadedTriangle corners;
  for (std::size_t k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) {
      corners[k][static_cast<std::size_t>(a)] = places[k][static_cast<std::size_t>(a)];
      corners[k][static_cast<std::size_t>(a) + 3] =
          static_cast<int>(std::lround(10 * normals[k][a]));
    }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}
std::multiset<ShadedTriangle> shaded(const TileMesh& mesh) {
  std::multiset<ShadedTriangle> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<LatticePoint, 3> places;
    std::array<Vec3, 3> normals;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      places[k] = mesh.positions[v];
      normals[k] = mesh.corner_normals[i][k].of(mesh.normals[v]);
    }
    triangles.insert(shaded(places, normals));
  }
  return triangles;
}
std::multiset<ShadedTriangle> shaded(const DecodedMesh& mesh, const OutputLattice& lattice) {
  std::multiset<ShadedTriangle> triangles;
  for (const auto& t : mesh.triangles) {
    std::array<LatticePoint, 3> places;
    std::array<Vec3, 3> normals;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &p = mesh.positions[t[k]], &n = mesh.normals[t[k]];
      places[k] = testing::snap(lattice, {p[0], p[1], p[2]});
      normals[k] = {n[0], n[1], n[2]};
    }
    triangles.insert(shaded(places, normals));
  }
  return triangles;
}

TEST(Pairs, CornersKeepTheSideOfTheirNormals) {
  for (const int sheets : {1, 3, 8}) {
    const TileMesh mesh = book(sheets, 12);
    const auto expected = shaded(mesh);
    EXPECT_EQ(shaded(decode_draco(encode_draco(mesh, {}).bytes), mesh.lattice), expected);
    EXPECT_EQ(shaded(decode_glb(glb_of(mesh, {})), mesh.lattice), expected) << sheets;
  }
}

TEST(Pairs, TheDigestTellsOtherLabelsApart) {
  const LatticeMesh mesh = with_pairs(book(3, 4));
  LatticeMesh other = mesh;
  std::swap(other.pairs[0].inside, other.pairs[0].outside);
  EXPECT_NE(digest(other), digest(mesh));
  other = mesh;
  other.pairs[2].inside += 1;
  EXPECT_NE(digest(other), digest(mesh));
}

TEST(Pairs, JoinedTilesHaveThePairsOfAll) {
  const TileMesh whole = book(6, 10);
  TileMesh parts[2];
  for (std::size_t p = 0; p < 2; ++p) {
    TileMesh& part = parts[p];
    part = whole;
    part.triangles.clear();
    part.corner_normals.clear();
    part.triangle_pairs.clear();
    // Each tile has a list of its own.
    part.pairs.clear();
    std::map<std::uint32_t, std::uint32_t> place;
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
      if (i % 7 % 2 != p) continue;
      const std::uint32_t pair = whole.triangle_pairs[i];
      if (place.try_emplace(pair, static_cast<std::uint32_t>(part.pairs.size())).second)
        part.pairs.push_back(whole.pairs[pair]);
      part.triangles.push_back(whole.triangles[i]);
      part.corner_normals.push_back(whole.corner_normals[i]);
      part.triangle_pairs.push_back(place[pair]);
    }
  }
  MeshAccumulator accumulator;
  for (const TileMesh& part : parts) accumulator.append(part);
  const TileMesh joined = accumulator.take();
  EXPECT_TRUE(std::is_sorted(joined.pairs.begin(), joined.pairs.end()));
  EXPECT_EQ(digest(with_pairs(joined)), digest(with_pairs(whole)));
}

// A cube of two halves: each half's boundary is closed, the wall in it counts for both.
TEST(Pairs, BoundariesOfLabelsAreMeasured) {
  TileMesh mesh;
  mesh.lattice = testing::small_lattice();
  mesh.pairs = {{3, 8}, {3, exterior}, {8, exterior}};
  const auto vertex = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x * 4 + y * 2 + z;
  };
  for (std::int32_t x = 0; x < 3; ++x)
    for (std::int32_t y = 0; y < 2; ++y)
      for (std::int32_t z = 0; z < 2; ++z) mesh.positions.push_back({100 + 10 * x, 20 * y, 30 * z});
  const auto quad = [&](std::array<std::uint32_t, 4> v, std::uint32_t pair) {
    mesh.triangles.push_back({v[0], v[1], v[2]});
    mesh.triangles.push_back({v[0], v[2], v[3]});
    mesh.triangle_pairs.insert(mesh.triangle_pairs.end(), {pair, pair});
  };
  // Facing up x: of 3 the wall and of 8 its end; of 3 the other end faces down.
  for (std::uint32_t x = 0; x < 3; ++x) {
    std::array v{vertex(x, 0, 0), vertex(x, 1, 0), vertex(x, 1, 1), vertex(x, 0, 1)};
    if (x == 0) std::swap(v[1], v[3]);
    quad(v, x == 0 ? 1 : x == 1 ? 0 : 2);
  }
  for (std::uint32_t x = 0; x < 2; ++x) {
    const std::uint32_t pair = x + 1;
    quad({vertex(x, 0, 0), vertex(x + 1, 0, 0), vertex(x + 1, 0, 1), vertex(x, 0, 1)}, pair);
    quad({vertex(x, 1, 1), vertex(x + 1, 1, 1), vertex(x + 1, 1, 0), vertex(x, 1, 0)}, pair);
    quad({vertex(x, 1, 0), vertex(x + 1, 1, 0), vertex(x + 1, 0, 0), vertex(x, 0, 0)}, pair);
    quad({vertex(x, 0, 1), vertex(x + 1, 0, 1), vertex(x + 1, 1, 1), vertex(x, 1, 1)}, pair);
  }
  const std::vector<LabelBoundary> boundaries = measure_labels(mesh);
  ASSERT_EQ(boundaries.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(boundaries[i].label, i == 0 ? 3u : 8u);
    EXPECT_EQ(boundaries[i].vertices, 8u);
    EXPECT_EQ(boundaries[i].triangles, 12u);
    EXPECT_TRUE(boundaries[i].measure.volume6 == 6 * 10 * 20 * 30);
    EXPECT_EQ(boundaries[i].measure.area2, 4 * (10 * 20 + 20 * 30 + 10 * 30));
  }
  EXPECT_EQ(boundaries[1].measure.lo, (LatticePoint{110, 0, 0}));
  EXPECT_EQ(boundaries[1].measure.hi, (LatticePoint{120, 20, 30}));
}

TEST(Pairs, DamagedFilesAreRefusedOrReadAsSomethingElse) {
  const EncodedMesh encoded = encode_draco(book(4, 6), {});
  std::mt19937 random(5);
  for (int run = 0; run < 2000; ++run) {
    std::vector<std::byte> bytes = encoded.bytes;
    if (run % 4 == 0) bytes.resize(random() % bytes.size());
    for (unsigned i = 0; i < 1 + random() % 3 && !bytes.empty(); ++i)
      bytes[random() % std::min<std::size_t>(bytes.size(), run % 2 ? 160 : 100000)] ^=
          static_cast<std::byte>(1u << random() % 8);
    try {
      const DecodedMesh mesh = decode_draco(bytes);
      EXPECT_TRUE(mesh.triangle_pairs.empty() ||
                  mesh.triangle_pairs.size() == mesh.triangles.size());
      for (const std::uint32_t pair : mesh.triangle_pairs) EXPECT_LT(pair, mesh.pairs.size());
    } catch (const FormatError&) {
    }
  }
}

TEST(Pairs, AreNamedInTheGlb) {
  const auto glb = glb_of(book(3, 4), {});
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < 4; ++i)
    length |= std::to_integer<std::uint32_t>(glb[12 + i]) << (8 * i);
  const auto doc =
      nlohmann::json::parse(std::string(reinterpret_cast<const char*>(glb.data()) + 20, length));
  const auto& primitives = doc["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 3u);
  EXPECT_EQ(primitives[0]["extras"]["inside"], 0);
  EXPECT_TRUE(primitives[0]["extras"]["outside"].is_null());
  EXPECT_EQ(primitives[1]["extras"]["outside"], high - 1);
  EXPECT_EQ(doc["materials"][0]["name"], "0 | outside");
  EXPECT_EQ(doc["materials"][1]["name"], "1 | " + std::to_string(high - 1));
  EXPECT_EQ(doc["materials"][1]["doubleSided"], true);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(primitives[i]["material"], i);
  EXPECT_NE(doc["materials"][0]["pbrMetallicRoughness"],
            doc["materials"][1]["pbrMetallicRoughness"]);
}

// Those of a table are sRGB, those of a file linear.
TEST(Pairs, HaveTheColoursTheirLabelsAreGiven) {
  MaterialTable table;
  table.entries = {{0, "first", MaterialColor{255, 0, 188}}, {1, "second", std::nullopt}};
  GlbParameters parameters;
  parameters.materials = &table;
  const auto colours = [&](const std::vector<std::byte>& glb) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
      length |= std::to_integer<std::uint32_t>(glb[12 + i]) << (8 * i);
    const auto doc =
        nlohmann::json::parse(std::string(reinterpret_cast<const char*>(glb.data()) + 20, length));
    std::vector<nlohmann::json> found;
    for (const auto& material : doc["materials"])
      found.push_back(material["pbrMetallicRoughness"].value("baseColorFactor", nlohmann::json()));
    return found;
  };
  const std::vector<TileMesh> parts = split_by_pair(book(3, 4));
  std::vector<GlbPart> glb_parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    glb_parts.push_back({encode_draco(parts[i], {}), book(3, 4).pairs[i]});
  const auto given = colours(wrap_glb(glb_parts, parameters));
  const auto by_number = colours(wrap_glb(glb_parts, {}));
  EXPECT_EQ(given[0], (nlohmann::json{1.0, 0.0, 0.50289, 1.0}));
  EXPECT_EQ(given[1], by_number[1]);  // of label 1, which has none
  EXPECT_NE(given[0], by_number[0]);
  // A mesh that is one label's has its colour, and none otherwise.
  const EncodedMesh whole = encode_draco(parts[0], {});
  EXPECT_TRUE(colours(wrap_glb(whole, parameters)).at(0).is_null());
  parameters.label = 1;
  EXPECT_TRUE(colours(wrap_glb(whole, parameters)).at(0).is_null());
  parameters.label = 0;
  EXPECT_EQ(colours(wrap_glb(whole, parameters)).at(0), given[0]);
}

}  // namespace
}  // namespace voxweld
