// Meshes between labels through Draco and glTF: the pairs come back, and nothing is lost where
// three triangles meet in an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "stages/encode/glb.h"
#include "stages/encode/label_boundary.h"
#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_accumulator.h"
#include "storage/support/error.h"
#include "tests/stages/encode/pair_book.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

using testing::book;
using testing::gltf_formats;
using testing::with_pairs;
using testing::written;

// 300: feature ids of 16 bits.
TEST(Pairs, ComeBackFromAllFormats) {
  for (const int sheets : {1, 2, 3, 5, 40, 300})
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
      for (const char* format : gltf_formats) {
        const auto glb = written(format, mesh, testing::facts_of(normals));
        const DecodedMesh decoded = decode_glb(glb);
        EXPECT_EQ(decoded.normals.empty(), !normals);
        const LatticeMesh welded = weld(decoded, mesh.lattice);
        EXPECT_EQ(digest(welded), expected) << sheets << format;
        EXPECT_EQ(welded.positions.size(), mesh.positions.size());
        EXPECT_EQ(written(format, mesh, testing::facts_of(normals)), glb);
      }
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
    for (const char* format : gltf_formats)
      EXPECT_EQ(shaded(decode_glb(written(format, mesh, {})), mesh.lattice), expected) << sheets;
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
  const TileMesh mesh = book(4, 6);
  using Decode = DecodedMesh (*)(std::span<const std::byte>, const std::string&);
  const std::pair<std::vector<std::byte>, Decode> files[] = {
      {encode_draco(mesh, {}).bytes, decode_draco},
      {written("glb", mesh, {}), decode_glb},
      {written("glb-plain", mesh, {}), decode_glb}};
  std::mt19937 random(5);
  for (const auto& [whole, decode] : files)
    for (int run = 0; run < 2000; ++run) {
      std::vector<std::byte> bytes = whole;
      if (run % 4 == 0) bytes.resize(random() % bytes.size());
      for (unsigned i = 0; i < 1 + random() % 3 && !bytes.empty(); ++i)
        bytes[random() % std::min<std::size_t>(bytes.size(), run % 2 ? 160 : 100000)] ^=
            static_cast<std::byte>(1u << random() % 8);
      try {
        const DecodedMesh decoded = decode(bytes, "a file");
        EXPECT_TRUE(decoded.triangle_pairs.empty() ||
                    decoded.triangle_pairs.size() == decoded.triangles.size());
        for (const std::uint32_t pair : decoded.triangle_pairs)
          EXPECT_LT(pair, decoded.pairs.size());
      } catch (const FormatError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("a file: ", 0), 0u) << error.what();
      }
    }
}

}  // namespace
}  // namespace voxweld
