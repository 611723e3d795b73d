// Choices of tiles that stand for the whole mesh, at any mix of levels.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "stages/encode/mesh_writers.h"
#include "storage/manifest/manifest.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/refine/refine_work.h"
#include "tests/support/mesh_check.h"

namespace voxweld::testing {

struct ListedMesh {
  TileRecord record;
  DecodedMesh mesh;
};

// Those of the mesh itself and of all levels.
inline std::vector<ListedMesh> all_meshes(const std::filesystem::path& output) {
  std::vector<ListedMesh> all;
  for (const char* name : {tiles_name, levels_name}) {
    TileListReader reader(output / name);
    while (auto record = reader.next()) {
      const FileRecord& file = record->files.front();
      const MeshWriter* const format = writer_named(mesh_writers(), file.format);
      all.push_back({*record, format->read(read_whole_file(output / file.path), file.path)});
    }
  }
  return all;
}

inline bool holds(const TileRecord& a, const TileRecord& b) {
  const auto end = [](const CellKey& c) { return c.code() + (std::uint64_t{1} << (3 * c.level)); };
  const CellKey inner = b.place.value_or(b.tile);
  return a.lod > b.lod && a.tile.code() <= inner.code() && end(inner) <= end(a.tile);
}

// Meshes that stand for the whole, each level here or there as the dice have it.
inline std::vector<const ListedMesh*> any_mix(const std::vector<ListedMesh>& all,
                                              std::mt19937& random) {
  std::vector<const ListedMesh*> order, shown;
  for (const ListedMesh& one : all) order.push_back(&one);
  std::ranges::stable_sort(order, {}, [](const ListedMesh* one) { return -one->record.lod; });
  for (const ListedMesh* one : order) {
    const bool covered = std::ranges::any_of(
        shown, [&](const ListedMesh* above) { return holds(above->record, one->record); });
    const bool taken = one->record.lod == 0 || random() % 3 == 0;
    if (!covered && taken) shown.push_back(one);
  }
  return shown;
}

inline WeldedMesh welded(const std::vector<const ListedMesh*>& shown) {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (const ListedMesh* one : shown) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const auto& p : one->mesh.positions) vertices.push_back({p[0], p[1], p[2]});
    for (const auto& t : one->mesh.triangles)
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return weld(vertices, triangles);
}

// With as many triangles as the manifest lists; and level 1 is drawn.
inline void expect_levels_are_exported(const Scene& scene) {
  const auto listed = manifest_of(scene.output()).at("levels");
  const std::string output = scene.output().string();
  const std::string ply = (scene.directory() / "level.ply").string();
  for (std::size_t level = 0; level < listed.size(); ++level) {
    const ProgramResult exported = run_voxweld(
        {"export", output, "-o", ply, "--weld", "--force", "--level", std::to_string(level)});
    VOXWELD_EXPECT_DONE(exported);
    const auto triangles = listed[level].at("triangles").get<std::uint64_t>();
    EXPECT_NE(exported.out.find(fmt::format(": {} triangles", triangles)), std::string::npos)
        << exported.out;
  }
  VOXWELD_EXPECT_DONE(run_voxweld({"render", output, "-o", ply + ".png", "--level", "1"}));
}

}  // namespace voxweld::testing
