// Holds encode_memory_bytes and accumulator_memory_bytes against every byte allocated.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <random>

#include "stages/encode/draco_codec.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/mesh_writers.h"
#include "tests/support/allocation_count.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

template <class Work>
std::uint64_t peak_of(Work work) {
  const std::uint64_t before = testing::live_bytes();
  testing::forget_peak();
  work();
  return testing::peak_bytes() - before;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const TileMesh& mesh, const EncodeParameters& parameters) {
  EncodedMesh encoded;
  const std::uint64_t v = mesh.positions.size(), t = mesh.triangles.size();
  auto start = std::chrono::steady_clock::now();
  const std::uint64_t encode_peak = peak_of([&] { encoded = encode_draco(mesh, parameters); });
  const double encode_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  const std::uint64_t decode_peak = peak_of([&] { decode_draco(encoded.bytes); });
  const double decode_seconds = seconds_since(start);
  const auto each = [&](std::uint64_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(t);
  };
  fmt::print(
      "{} triangles, normals {}, speed {}: {:.3f} bytes, encode {:.3f} s {:.0f} bytes, decode "
      "{:.3f} s {:.0f} bytes (sizes a triangle)\n",
      t, parameters.normals, parameters.encode_speed, each(encoded.bytes.size()), encode_seconds,
      each(encode_peak), decode_seconds, each(decode_peak));
  EXPECT_LE(encode_peak, encode_memory_bytes(v, t, parameters.normals));
}

TEST(EncodeMemory, OfStreamsStaysUnderTheFigureTheBudgetUses) {
  const OutputLattice lattice{1.0 / 4096, 20, {-2, -2, -2}};
  TileMesh mesh = testing::make_torus({.around = 300, .across = 150}, lattice);
  std::mt19937 random(1);
  for (auto& corners : mesh.corner_normals)
    for (auto& c : corners)
      c = CornerNormal::make(static_cast<int>(random() % max_clusters), random() % 2 != 0);
  const std::vector<TileMesh> tiles = testing::cut_into_tiles(mesh, 4);
  std::uint64_t most = 0, kept = 0;
  for (const TileMesh& tile : tiles) {
    most = std::max<std::uint64_t>(most, tile.positions.size());
    kept += TileWelder::kept_bytes(tile.positions.size(), false);
  }
  const EachTile each_tile = [&](const auto& f) {
    for (const TileMesh& tile : tiles) f(tile);
  };
  const StreamTotals totals = totals_of(each_tile);
  for (const MeshWriter& writer : mesh_writers()) {
    if (writer.stream == nullptr) continue;
    std::uint64_t bytes = 0;
    const std::uint64_t peak = peak_of([&] {
      writer.stream(each_tile, totals,
                    [&](std::span<const std::byte> some) { bytes += some.size(); });
    });
    EXPECT_LE(peak, stream_bytes(most) + kept) << writer.name;
    EXPECT_GT(bytes, 50 * mesh.triangles.size() / 4) << writer.name;
  }
}

// Between labels: few pairs with large faces, and one for every polygon, as of noise.
TEST(EncodeMemory, OfPairsStaysUnderTheFigureTheBudgetUses) {
  const OutputLattice lattice{1.0 / 4096, 20, {-2, -2, -2}};
  TileMesh mesh = testing::make_torus({.around = 500, .across = 250}, lattice);
  MaterialTable names;
  for (Material label = 0; label < mesh.triangles.size(); ++label)
    names.entries.push_back({label, std::string(50, 'n'), MaterialColor{1, 2, 3}});
  AssetFacts facts;
  facts.materials = &names;
  for (const bool normals : {true, false}) {
    facts.encoding.normals = normals;
    for (const std::size_t polygons : {1u, 3u, 10u, 100u, 1000u}) {
      mesh.pairs.clear();
      mesh.triangle_pairs.clear();
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (t % (2 * polygons) == 0) mesh.pairs.push_back({t, t + 1});
        mesh.triangle_pairs.push_back(static_cast<std::uint32_t>(mesh.pairs.size() - 1));
      }
      const std::uint64_t v = mesh.positions.size(), t = mesh.triangles.size();
      for (const MeshWriter& writer : mesh_writers()) {
        if (!writer.holds_labels || writer.is_streamed()) continue;
        std::uint64_t bytes = 0;
        const std::uint64_t peak = peak_of([&] {
          Asset asset(mesh, facts);
          writer.write(asset, [&](std::span<const std::byte> some) { bytes += some.size(); });
        });
        const std::uint64_t planned =
            encode_memory_bytes(v, t, normals, true) + writer.pair_bytes * mesh.pairs.size();
        fmt::print(
            "{}, normals {}, {} pairs: {} bytes, {} bytes of memory a triangle, planned {}\n",
            writer.name, normals, mesh.pairs.size(), bytes, peak / t, planned / t);
        EXPECT_LE(peak, planned) << writer.name;
      }
    }
  }
}

TEST(EncodeMemory, StaysUnderTheFigureTheBudgetUses) {
  // VOXWELD_MEASURE=1000 measures a million triangles (n^2) at every speed.
  const char* size = std::getenv("VOXWELD_MEASURE");
  const bool large = size != nullptr;
  const int n = large ? std::atoi(size) : 250;
  const OutputLattice lattice{1.0 / 4096, 20, {-2, -2, -2}};
  const TileMesh torus = testing::make_torus({.around = n, .across = n / 2}, lattice);
  // The worst there is: noise, and a seam at every edge.
  TileMesh noisy = torus;
  std::mt19937 random(1);
  for (auto& q : noisy.positions)
    for (auto& c : q) c += static_cast<std::int32_t>(random() % 400);
  for (auto& corners : noisy.corner_normals)
    for (auto& c : corners)
      c = CornerNormal::make(static_cast<int>(random() % max_clusters), random() % 2 != 0);
  const TileMesh cube = testing::make_cube(lattice, {1, 1, 1}, 100, n / 4);
  for (const TileMesh* mesh : std::initializer_list<const TileMesh*>{&torus, &cube, &noisy}) {
    for (const bool normals : {false, true}) {
      for (int speed = 0; speed <= 10; speed += large ? 1 : 5)
        measure(*mesh, {.normals = normals, .encode_speed = speed, .decode_speed = speed});
    }
  }
}

TEST(AccumulatorMemory, StaysUnderTheFigureTheBudgetUses) {
  const TileMesh torus =
      testing::make_torus({.around = 250, .across = 125}, testing::small_lattice());
  for (const int level : {2, 3, 6}) {
    const std::vector<TileMesh> tiles = testing::cut_into_tiles(torus, level);
    std::uint64_t vertices = 0, triangles = 0;
    for (const TileMesh& tile : tiles) {
      vertices += tile.positions.size();
      triangles += tile.triangles.size();
    }
    MeshAccumulator accumulator;
    const std::uint64_t peak = peak_of([&] {
      for (const TileMesh& tile : tiles) accumulator.append(tile);
    });
    EXPECT_LE(peak, accumulator_memory_bytes(vertices, triangles, true)) << tiles.size();
  }
}

}  // namespace
}  // namespace voxweld
