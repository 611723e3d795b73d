#include "pipeline/output/load.h"

#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {

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
    const std::function<void(const std::filesystem::path&, std::optional<Material> label)>& f) {
  if (!std::filesystem::is_directory(path)) return f(path, std::nullopt);
  require_output(path);
  bool any = false;
  TileListReader tiles(path / tiles_name);
  while (const auto tile = tiles.next()) {
    if (tile->files.empty()) continue;
    f(path / tile->files.front().path, tile->label);
    any = true;
  }
  if (any) return;
  const Manifest manifest = read_manifest(path / manifest_name);
  if (!manifest.merged || manifest.merged->empty())
    throw InputError(path.string() + ": the manifest lists no mesh");
  f(path / manifest.merged->begin()->second, std::nullopt);
}

void for_each_mesh(const std::filesystem::path& path,
                   const std::function<void(const DecodedMesh&, std::optional<Material> label)>& f,
                   MeshWriters formats) {
  each_mesh_file(path, [&](const std::filesystem::path& file, std::optional<Material> label) {
    f(load_mesh(file, formats), label);
  });
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
