#include "pipeline/output/load.h"

#include "stages/encode/glb.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {

DecodedMesh load_mesh(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (!std::filesystem::exists(path)) throw InputError(name + ": no such file");
  if (path.extension() == ".drc") return decode_draco(read_whole_file(path), name);
  if (path.extension() == ".glb") return decode_glb(read_whole_file(path), name);
  if (std::filesystem::is_directory(path))
    throw InputError(name + ": is a directory; name one .drc or .glb file");
  throw InputError(name + ": not a mesh file; expected .drc or .glb");
}

void for_each_mesh(const std::filesystem::path& path,
                   const std::function<void(const DecodedMesh&)>& f) {
  for_each_label_mesh(path, [&](const DecodedMesh& mesh, std::optional<Material>) { f(mesh); });
}

void for_each_label_mesh(
    const std::filesystem::path& path,
    const std::function<void(const DecodedMesh&, std::optional<Material> label)>& f) {
  if (!std::filesystem::is_directory(path)) {
    f(load_mesh(path), std::nullopt);
    return;
  }
  bool any = false;
  TileListReader tiles(path / tiles_name);
  while (const auto tile = tiles.next()) {
    if (tile->files.empty()) continue;
    f(load_mesh(path / tile->files.front().path), tile->label);
    any = true;
  }
  if (any) return;
  const Manifest manifest = read_manifest(path / manifest_name);
  if (!manifest.merged) throw InputError(path.string() + ": the manifest lists no mesh");
  f(load_mesh(path / (manifest.merged->drc.empty() ? manifest.merged->glb : manifest.merged->drc)),
    std::nullopt);
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
