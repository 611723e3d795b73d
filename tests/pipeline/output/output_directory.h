// Writes a small output directory as a run does, and lets a test damage it first.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/output/tile_check.h"
#include "pipeline/output/verify.h"
#include "stages/encode/glb.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/mesh_measure.h"
#include "storage/manifest/manifest.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

struct OutputDirectory {
  std::vector<TileMesh> tiles;
  std::vector<Material> labels;  // of each tile, ascending; empty: one surface
  bool glb = true, merged = true, open = false, free_topology = false;
  bool listed = true;  // else the tiles are not written: the merged mesh is all there is
  // Hooks, each called where set: on a tile's mesh before it is encoded (the merged mesh and the
  // listing are made from the meshes before), on the listing, on the manifest.
  std::function<void(std::size_t, TileMesh&)> damage;
  std::function<void(std::size_t, TileRecord&)> relist;
  std::function<void(LabelRecord&)> relabel;
  std::function<void(Manifest&)> restate;
  std::function<void(TileMesh&)> remerge;
  bool streamed =
      false;  // the merged mesh in the formats that need not hold it, in place of others

  void write(const std::filesystem::path& directory) const {
    Manifest manifest;
    manifest.lattice = tiles[0].lattice;
    manifest.open_border = open;
    manifest.free_topology = free_topology;
    manifest.frame.size = {40, 40, 40};
    manifest.frame.unit = "mm";
    std::string list;
    std::map<Material, std::set<std::array<std::int32_t, 3>>> vertices;
    MeshAccumulator accumulator;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (merged) accumulator.append(tiles[i]);
      vertices[labels.empty() ? 0 : labels[i]].insert(tiles[i].positions.begin(),
                                                      tiles[i].positions.end());
      list += line(directory, i, manifest.counts);
    }
    if (!listed) {
      list.clear();
      manifest.counts.tiles = 0;
      std::filesystem::remove_all(directory / "tiles");
    }
    for (const auto& [label, points] : vertices) manifest.counts.vertices += points.size();
    if (!labels.empty()) write_labels(directory, vertices, manifest);
    if (merged) write_merged(directory, accumulator.take(), manifest);
    if (restate) restate(manifest);
    write_manifest(manifest, directory / manifest_name, Durability::rename_only);
    write_whole_file(directory / tiles_name, as_bytes(list), Durability::rename_only);
  }

 private:
  void write_labels(const std::filesystem::path& directory,
                    const std::map<Material, std::set<std::array<std::int32_t, 3>>>& vertices,
                    Manifest& manifest) const {
    manifest.labels = LabelMode::each;
    manifest.counts.labels = vertices.size();
    std::string list;
    for (const auto& [label, points] : vertices) {
      LabelRecord record;
      record.label = label;
      record.vertices = points.size();
      MeshMeasure sum;
      for (std::size_t i = 0; i < tiles.size(); ++i) {
        if (labels[i] != label) continue;
        sum += measure(tiles[i].positions, tiles[i].triangles);
        record.triangles += tiles[i].triangles.size();
        ++record.tiles;
        record.files.push_back("tiles/" + std::to_string(i) + ".drc");
        if (glb) record.files.push_back("tiles/" + std::to_string(i) + ".glb");
      }
      if (!open) record.volume = enclosed_volume(sum, manifest.lattice);
      record.area = surface_area(sum, manifest.lattice);
      const PointFrame frame(manifest);
      record.bounds = {frame.position(sum.lo), frame.position(sum.hi)};
      if (relabel) relabel(record);
      list += to_json_line(record);
    }
    manifest.files.push_back(file(directory, labels_name, "jsonl", "labels", as_bytes(list)));
  }

  static FileRecord file(const std::filesystem::path& directory, const std::string& path,
                         const std::string& format, const std::string& role,
                         std::span<const std::byte> bytes) {
    write_whole_file(directory / path, bytes, Durability::rename_only);
    return {path, format, role, bytes.size(), to_hex(hash_bytes(bytes))};
  }

  std::string line(const std::filesystem::path& directory, std::size_t i,
                   ManifestCounts& counts) const {
    TileMesh mesh = tiles[i];
    TileRecord record{{},
                      mesh.tile,
                      mesh.positions.size(),
                      mesh.triangles.size(),
                      mesh.quads,
                      mesh.polygon_triangles,
                      {}};
    if (!labels.empty()) record.label = labels[i];
    counts.quads += mesh.quads;
    counts.triangles += mesh.triangles.size();
    counts.tiles += 1;
    if (damage) damage(i, mesh);
    const EncodedMesh encoded = encode_draco(mesh, {});
    const std::string name = "tiles/" + std::to_string(i);
    record.files.push_back(file(directory, name + ".drc", "drc", "", encoded.bytes));
    if (glb)
      record.files.push_back(file(directory, name + ".glb", "glb", "", wrap_glb(encoded, {})));
    if (relist) relist(i, record);
    return to_json_line(record);
  }

  void write_merged(const std::filesystem::path& directory, TileMesh mesh,
                    Manifest& manifest) const {
    if (remerge) remerge(mesh);
    if (streamed) return write_streams(directory, mesh, manifest);
    const EncodedMesh encoded = encode_draco(mesh, {});
    manifest.merged = MergedFiles{{"drc", "mesh.drc"}, {"glb", "mesh.glb"}};
    manifest.files.push_back(file(directory, "mesh.drc", "drc", "merged", encoded.bytes));
    manifest.files.push_back(file(directory, "mesh.glb", "glb", "merged", wrap_glb(encoded, {})));
  }

  static void write_streams(const std::filesystem::path& directory, const TileMesh& mesh,
                            Manifest& manifest) {
    const AssetFacts facts;
    Asset asset(mesh, facts);
    manifest.merged = MergedFiles{};
    for (const MeshWriter& writer : mesh_writers()) {
      if (writer.stream == nullptr) continue;
      std::vector<std::byte> bytes;
      writer.write(asset, [&](std::span<const std::byte> some) {
        bytes.insert(bytes.end(), some.begin(), some.end());
      });
      const std::string name(writer.name), path = "mesh" + std::string(writer.ending);
      manifest.merged->emplace(name, path);
      manifest.files.push_back(file(directory, path, name, "merged", bytes));
    }
  }
};

// A hook for one of the tiles.
template <class F>
auto of_tile(std::size_t tile, F f) {
  return [=](std::size_t i, auto& what) {
    if (i == tile) f(what);
  };
}

inline void without_last_triangle(TileMesh& mesh) {
  mesh.triangles.pop_back();
  mesh.corner_normals.pop_back();
}

inline VerifyReport verified(const OutputDirectory& output, const VerifyOptions& options = {}) {
  const TempDirectory directory;
  output.write(directory.path());
  return verify_output(directory.path(), options);
}

inline void expect_problem(const OutputDirectory& output, const std::string& what) {
  const VerifyReport report = verified(output, {.listed_problems = 1000});
  EXPECT_FALSE(report.good());
  EXPECT_THAT(to_text(report), ::testing::HasSubstr(what));
}

}  // namespace voxweld::testing
