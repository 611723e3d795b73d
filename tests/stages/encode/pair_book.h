// Meshes between labels for tests, as files of the formats.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_writers.h"
#include "tests/support/shapes.h"

namespace voxweld::testing {

inline constexpr Material high_label = 0xfffffffffffffffeu;

// A book: sheets of squares that meet in one row of edges, each sheet between two labels.
inline TileMesh book(int sheets, int length) {
  TileMesh mesh;
  mesh.lattice = small_lattice();
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
        {static_cast<Material>(s), s == 0 ? exterior : high_label - static_cast<Material>(s)});
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

inline LatticeMesh with_pairs(const TileMesh& mesh) {
  LatticeMesh out{mesh.positions, mesh.triangles, {}};
  for (const std::uint32_t pair : mesh.triangle_pairs) out.pairs.push_back(mesh.pairs[pair]);
  return out;
}

inline std::vector<std::byte> written(const char* format, const TileMesh& mesh,
                                      const AssetFacts& facts) {
  Asset asset(mesh, facts);
  std::vector<std::byte> file;
  writer_named(mesh_writers(), format)->write(asset, [&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
  });
  return file;
}

inline AssetFacts facts_of(bool normals, const MaterialTable* materials = nullptr) {
  AssetFacts facts;
  facts.encoding.normals = normals;
  facts.materials = materials;
  return facts;
}

inline nlohmann::json document_of(const std::vector<std::byte>& glb) {
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < 4; ++i)
    length |= std::to_integer<std::uint32_t>(glb[12 + i]) << (8 * i);
  return nlohmann::json::parse(std::string(reinterpret_cast<const char*>(glb.data()) + 20, length));
}

// What the bytes of a view are.
inline std::string view_of(const std::vector<std::byte>& glb, const nlohmann::json& doc,
                           const nlohmann::json& number) {
  const auto& view = doc["bufferViews"][number.get<std::size_t>()];
  const std::size_t bin = glb.size() - doc["buffers"][0]["byteLength"].get<std::size_t>();
  return {reinterpret_cast<const char*>(glb.data()) + bin + view["byteOffset"].get<std::size_t>(),
          view["byteLength"].get<std::size_t>()};
}

inline constexpr const char* gltf_formats[] = {"glb", "glb-plain"};

}  // namespace voxweld::testing
