#include "stages/encode/draco_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "stages/encode/corner_points.h"
#include "stages/encode/draco_mesh.h"
#include "stages/encode/lattice_mesh.h"
#include "storage/support/error.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

using testing::make_cube;
using testing::make_torus;
using testing::small_lattice;

LatticeMesh as_lattice_mesh(const TileMesh& mesh) {
  return {mesh.positions, mesh.triangles};
}

// Separate triangles over extreme and random coordinates of the lattice.
TileMesh random_triangles(const OutputLattice& lattice, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::int32_t last = (std::int32_t{1} << lattice.bits) - 1;
  std::uniform_int_distribution<std::int32_t> any(0, last);
  std::set<LatticePoint> points{{0, 0, 0},        {last, last, last},     {last, 0, 0},
                                {0, last, 0},     {0, 0, last},           {last - 1, last, last},
                                {1, 1, 1},        {last, last - 1, last}, {last, last, last - 1},
                                {0, 1, last - 1}, {last / 2, 0, 1},       {last / 2 + 1, 0, 1}};
  while (points.size() < 3000) points.insert({any(random), any(random), any(random)});
  TileMesh mesh;
  mesh.lattice = lattice;
  mesh.positions.assign(points.begin(), points.end());
  std::shuffle(mesh.positions.begin(), mesh.positions.end(), random);
  for (std::uint32_t v = 0; v + 2 < mesh.positions.size(); v += 3)
    mesh.triangles.push_back({v, v + 1, v + 2});
  return mesh;
}

void expect_exact(const OutputLattice& lattice, int speed) {
  const TileMesh mesh = random_triangles(lattice, static_cast<std::uint64_t>(lattice.bits));
  const EncodedMesh encoded =
      encode_draco(mesh, {.normals = false, .encode_speed = speed, .decode_speed = speed});
  const LatticeMesh decoded = weld(decode_draco(encoded.bytes), lattice);
  EXPECT_EQ(decoded.positions.size(), mesh.positions.size());
  EXPECT_EQ(digest(decoded), digest(as_lattice_mesh(mesh))) << lattice.bits << " " << lattice.step;
}

TEST(DracoCodec, DecodesEveryLatticeCoordinateExactlyFrom16To22Bits) {
  for (int bits = 16; bits <= 22; ++bits) {
    for (const double step : {1.0, 1.0 / 1024, 16.0, std::ldexp(1.0, -20)}) {
      OutputLattice lattice{step, bits, {}};
      lattice.origin = {-lattice.range(), -step * 3, 0};
      for (const int speed : {0, 5, 7, 10}) expect_exact(lattice, speed);
      // As far from 0 as floats go.
      lattice.origin = {-16777216 * step, 16777216 * step - lattice.range(), step * 12345};
      for (const int speed : {0, 7}) expect_exact(lattice, speed);
    }
  }
}

TEST(DracoCodec, KeepsConnectivityAndReportsWhatTheDecoderSees) {
  const TileMesh meshes[] = {make_torus({}, small_lattice()),
                             make_cube(small_lattice(), {1, 2, 3}, 8, 5)};
  for (const TileMesh& mesh : meshes) {
    for (const bool normals : {false, true}) {
      for (int speed = 0; speed <= 10; ++speed) {
        const EncodedMesh encoded =
            encode_draco(mesh, {.normals = normals, .encode_speed = speed, .decode_speed = speed});
        const DecodedMesh decoded = decode_draco(encoded.bytes);
        EXPECT_EQ(encoded.points, decoded.positions.size()) << speed;
        EXPECT_EQ(encoded.triangles, decoded.triangles.size());
        for (std::size_t a = 0; a < 3; ++a) {
          const auto along = [a](const std::array<float, 3>& p) { return p[a]; };
          const auto [lo, hi] = std::ranges::minmax(decoded.positions, {}, along);
          EXPECT_EQ(encoded.lo[a], lo[a]);
          EXPECT_EQ(encoded.hi[a], hi[a]);
        }
        EXPECT_EQ(encoded.position_id, decoded.position_id);
        EXPECT_EQ(encoded.normal_id, decoded.normal_id);
        EXPECT_EQ(digest(weld(decoded, mesh.lattice)), digest(as_lattice_mesh(mesh)));
      }
    }
  }
}

TEST(DracoCodec, ReportsThePointsOfBowTiesAndUnusedVertices) {
  TileMesh mesh = make_cube(small_lattice(), {1, 1, 1}, 2);
  const TileMesh other = make_cube(small_lattice(), {3, 3, 3}, 2);
  // The second cube's first corner is the first one's last: one vertex, two fans.
  const auto shared = std::find(mesh.positions.begin(), mesh.positions.end(), other.positions[0]);
  ASSERT_NE(shared, mesh.positions.end());
  const auto at = static_cast<std::uint32_t>(shared - mesh.positions.begin());
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& t : other.triangles) {
    auto& corner = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) corner[k] = t[k] == 0 ? at : base + t[k];
  }
  for (const int speed : {0, 5, 10}) {
    const EncodedMesh encoded =
        encode_draco(mesh, {.normals = false, .encode_speed = speed, .decode_speed = speed});
    EXPECT_EQ(encoded.points, decode_draco(encoded.bytes).positions.size()) << speed;
    EXPECT_EQ(weld(decode_draco(encoded.bytes), mesh.lattice).positions.size(), 15u);
  }
}

TEST(DracoCodec, CornersGetTheNormalOfTheirCluster) {
  const TileMesh mesh = make_cube(small_lattice(), {1, 2, 3}, 8, 3);
  const DecodedMesh decoded = decode_draco(encode_draco(mesh, {}).bytes);
  ASSERT_EQ(decoded.normals.size(), decoded.positions.size());
  for (const Triangle& t : decoded.triangles) {
    Vec3 p[3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t a = 0; a < 3; ++a) p[k][static_cast<int>(a)] = decoded.positions[t[k]][a];
    Vec3 face = cross(p[1] - p[0], p[2] - p[0]);
    face = face * (1 / std::sqrt(dot(face, face)));
    for (const std::uint32_t v : t) {
      const auto& n = decoded.normals[v];
      EXPECT_GT(dot(face, Vec3{n[0], n[1], n[2]}), 0.999);
    }
  }
}

// By the places of a triangle's corners, the least of them first, its corners' normals.
using ThreeFloats = std::array<std::array<float, 3>, 3>;
std::map<ThreeFloats, ThreeFloats> normals_by_corners(const DecodedMesh& mesh) {
  std::map<ThreeFloats, ThreeFloats> normals;
  for (Triangle t : mesh.triangles) {
    // Not ranges::rotate: of its result clang 14 makes nothing.
    const auto least =
        std::ranges::min_element(t, {}, [&](std::uint32_t v) { return mesh.positions[v]; });
    std::rotate(t.begin(), least, t.end());
    ThreeFloats places, of_corner;
    for (std::size_t k = 0; k < 3; ++k) {
      places[k] = mesh.positions[t[k]];
      of_corner[k] = mesh.normals[t[k]];
    }
    normals.emplace(places, of_corner);
  }
  return normals;
}

TEST(DracoCodec, FewSeamsAreCutsOfTheConnectivity) {
  for (const auto& [across, cut] : {std::pair(40, true), {14, true}, {8, false}}) {
    const TileMesh mesh = make_torus({.around = 60, .across = across}, small_lattice());
    const std::vector<std::byte> bytes = encode_draco(mesh, {}).bytes;
    // A seam's vertices are there twice where it is cut: with one normal each.
    const auto there = decode_draco_mesh(bytes, "test");
    const auto circle = static_cast<std::uint32_t>(60);
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
    EXPECT_EQ(there->num_points(), vertices + circle);
    EXPECT_EQ(there->GetNamedAttribute(draco::GeometryAttribute::POSITION)->size(),
              cut ? vertices + circle : vertices)
        << across;

    const auto expected = normals_by_corners(corner_points(mesh, true));
    const auto decoded = normals_by_corners(decode_draco(bytes));
    ASSERT_EQ(decoded.size(), mesh.triangles.size());
    for (const auto& [places, normals] : expected) {
      ASSERT_TRUE(decoded.contains(places));
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t a = 0; a < 3; ++a)
          EXPECT_NEAR(decoded.at(places)[k][a], normals[k][a], 0.004);
    }
  }
}

TEST(DracoCodec, SeamVerticesDecodeToTheSameBitsInEveryTile) {
  const TileMesh mesh = make_torus({.around = 60, .across = 40}, small_lattice());
  const auto tiles = testing::cut_into_tiles(mesh, 3);
  ASSERT_GT(tiles.size(), 8u);
  std::map<LatticePoint, std::array<float, 3>> seen;
  TriangleDigest sum;
  std::size_t seams = 0;
  for (const TileMesh& tile : tiles) {
    const DecodedMesh decoded = decode_draco(encode_draco(tile, {}).bytes);
    sum += digest(weld(decoded, mesh.lattice));
    for (const auto& p : decoded.positions) {
      const auto [found, added] =
          seen.try_emplace(testing::snap(mesh.lattice, {p[0], p[1], p[2]}), p);
      seams += !added;
      using Bits = std::array<std::uint32_t, 3>;
      EXPECT_EQ(std::bit_cast<Bits>(found->second), std::bit_cast<Bits>(p));
    }
  }
  EXPECT_GT(seams, 100u);
  EXPECT_EQ(seen.size(), mesh.positions.size());
  EXPECT_EQ(sum, digest(as_lattice_mesh(mesh)));
}

TEST(DracoCodec, TheSameMeshGivesTheSameBytes) {
  const TileMesh mesh = make_torus({}, small_lattice());
  EXPECT_EQ(encode_draco(mesh, {}).bytes, encode_draco(mesh, {}).bytes);
}

TEST(DracoCodec, RefusesMeshesItCannotKeep) {
  const TileMesh good = make_cube(small_lattice(), {1, 1, 1}, 2);
  const auto refused = [](TileMesh mesh, auto change) {
    change(mesh);
    EXPECT_THROW(encode_draco(mesh, {}), InputError);
  };
  refused(good, [](TileMesh& m) { m.triangles.clear(), m.corner_normals.clear(); });
  refused(good, [](TileMesh& m) { m.triangles[3][1] = 8; });
  refused(good, [](TileMesh& m) { m.triangles[3][1] = m.triangles[3][0]; });
  refused(good, [](TileMesh& m) { m.positions[2][1] = -1; });
  refused(good, [](TileMesh& m) { m.positions[2][1] = 1 << 14; });
  refused(good, [](TileMesh& m) { m.lattice.bits = 23; });
  refused(good, [](TileMesh& m) { m.lattice.step = 0.3; });
  refused(good, [](TileMesh& m) { m.lattice.origin[0] = -0.3; });
  refused(good, [](TileMesh& m) { m.lattice.origin[0] = 16777216 * m.lattice.step; });
  refused(good, [](TileMesh& m) { m.lattice.origin[2] = -16777217 * m.lattice.step; });
  refused(good, [](TileMesh& m) { m.normals.pop_back(); });
  refused(good, [](TileMesh& m) { m.corner_normals[0][0] = {3}; });
}

// Whatever is not refused must at least come back as a mesh in range.
void decode_or_refuse(std::span<const std::byte> bytes) {
  try {
    const DecodedMesh mesh = decode_draco(bytes, "tile.drc");
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) ASSERT_LT(v, mesh.positions.size());
  } catch (const FormatError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("tile.drc: ", 0), 0u) << error.what();
  }
}

TEST(DracoCodec, RefusesEveryTruncation) {
  for (const int speed : {0, 5, 10}) {
    const auto bytes = encode_draco(make_torus({}, small_lattice()),
                                    {.encode_speed = speed, .decode_speed = speed})
                           .bytes;
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_THROW(decode_draco(std::span(bytes).first(size)), FormatError) << size;
  }
}

TEST(DracoCodec, SurvivesFlippedBits) {
  for (const int speed : {0, 5, 10}) {
    const auto bytes = encode_draco(make_torus({}, small_lattice()),
                                    {.encode_speed = speed, .decode_speed = speed})
                           .bytes;
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        auto flipped = bytes;
        flipped[at] ^= static_cast<std::byte>(1 << bit);
        decode_or_refuse(flipped);
      }
    }
  }
}

}  // namespace
}  // namespace voxweld
