#include "pipeline/output/load.h"

#include <fmt/format.h>

#include "pipeline/output/level_cut.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

// What is shown of the directory's lists at that level.
LevelCut cut_of(const std::filesystem::path& output, int level) {
  if (level == 0) return LevelCut({}, 0);
  const std::vector<LevelTile> tiles = listed_levels(output);
  if (level < 0 || level > top_of(tiles))
    throw InputError(fmt::format(
        "level {}: {} has {}; give a smaller number, or set output.levels to a larger one and run "
        "again",
        level, output.string(),
        tiles.empty() ? std::string("level 0 alone, as a mesh of one tile also has with "
                                    "output.levels = \"auto\"")
                      : fmt::format("levels 0 to {}", top_of(tiles))));
  return LevelCut(tiles, level);
}

// The meshes that a coarse tile of labels has: none of them has a point in common with another.
void each_label(const DecodedMesh& mesh,
                const std::function<void(const DecodedMesh&, std::optional<Material>)>& f) {
  std::vector<DecodedMesh> parts(mesh.pairs.size());
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(mesh.positions.size(), none);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    DecodedMesh& part = parts[mesh.triangle_pairs[t]];
    auto triangle = mesh.triangles[t];
    for (std::uint32_t& corner : triangle) {
      std::uint32_t& own = number[corner];
      if (own == none) {
        own = static_cast<std::uint32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[corner]);
        if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[corner]);
      }
      corner = own;
    }
    part.triangles.push_back(triangle);
  }
  for (std::size_t i = 0; i < parts.size(); ++i) f(parts[i], mesh.pairs[i].inside);
}

}  // namespace

DecodedMesh load_mesh(const std::filesystem::path& path, MeshWriters formats) {
  const std::string name = path.string();
  if (!std::filesystem::exists(path)) throw InputError(name + ": no such file");
  const MeshWriter* format = writer_of_file(formats, path.filename().string());
  if (format != nullptr) return format->read(read_whole_file(path), name);
  if (std::filesystem::is_directory(path))
    throw InputError(name + ": is a directory; name one " + endings_text(formats) + " file");
  throw InputError(name + ": not a mesh file; expected " + endings_text(formats));
}

void each_mesh_file(
    const std::filesystem::path& path,
    const std::function<void(const std::filesystem::path&, std::optional<Material> label)>& f,
    int level) {
  if (!std::filesystem::is_directory(path)) {
    if (level != 0)
      throw InputError(path.string() + ": is one mesh; only output directories have levels");
    return f(path, std::nullopt);
  }
  require_output(path);
  bool any = false;
  const LevelCut cut = cut_of(path, level);
  for (const char* list : {tiles_name, levels_name}) {
    if (list != tiles_name && level == 0) continue;
    TileListReader tiles(path / list);
    while (const auto tile = tiles.next()) {
      if (tile->files.empty() || !cut.takes(*tile)) continue;
      f(path / tile->files.front().path, tile->label);
      any = true;
    }
  }
  if (any) return;
  const Manifest manifest = read_manifest(path / manifest_name);
  if (!manifest.merged || manifest.merged->empty())
    throw InputError(path.string() + ": the manifest lists no mesh");
  f(path / manifest.merged->begin()->second, std::nullopt);
}

void for_each_mesh(const std::filesystem::path& path,
                   const std::function<void(const DecodedMesh&, std::optional<Material> label)>& f,
                   MeshWriters formats, int level) {
  const bool of_each_label = level > 0 && std::filesystem::exists(path / manifest_name) &&
                             read_manifest(path / manifest_name).labels == LabelMode::each;
  each_mesh_file(
      path,
      [&](const std::filesystem::path& file, std::optional<Material> label) {
        const DecodedMesh mesh = load_mesh(file, formats);
        if (of_each_label && !label)
          each_label(mesh, f);
        else
          f(mesh, label);
      },
      level);
}

MaterialTable listed_colours(const std::filesystem::path& path) {
  MaterialTable table;
  if (!std::filesystem::exists(path / labels_name)) return table;
  LabelListReader labels(path / labels_name);
  while (const auto label = labels.next())
    if (const auto& c = label->color)
      table.entries.push_back({label->label, {}, MaterialColor{(*c)[0], (*c)[1], (*c)[2]}});
  return table;
}

}  // namespace voxweld
